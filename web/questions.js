// @ts-check
// The list of questions, narrowed down as somebody types: a number finds that question, words find those that hold all
// of them. The search stands in the address, so that a link can name it.
(() => {
    "use strict";
    const query = /** @type {HTMLInputElement} */ (document.getElementById("query"));
    const topic = /** @type {HTMLSelectElement} */ (document.getElementById("topic"));
    const answered = /** @type {HTMLInputElement} */ (document.getElementById("answered"));
    const found = /** @type {HTMLOutputElement} */ (document.getElementById("found"));
    const items = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("#list > li")]);

    /**
     * Without accents and capitals.
     * @param {string} text
     */
    const plain = (text) => text.normalize("NFD").replace(/[\u0300-\u036f]/g, "").toLowerCase();
    const texts = items.map((item) => plain(item.dataset.text ?? ""));

    function filter() {
        const words = plain(query.value).split(/\s+/).filter(Boolean);
        const number = words.length === 1 && /^\d+$/.test(words[0] ?? "") ? words[0] : undefined;
        let count = 0;
        items.forEach((item, i) => {
            const named = number ? item.dataset.number === number : words.every((word) => texts[i]?.includes(word));
            const shown = named && (topic.value === "" || item.dataset.topic === topic.value) &&
                (!answered.checked || item.dataset.answered !== undefined);
            item.hidden = !shown;
            count += shown ? 1 : 0;
        });
        found.textContent = count === 1 ? "1 question" : count + " questions";
    }

    const given = new URLSearchParams(location.search);
    query.value = given.get("query") ?? "";
    topic.value = given.get("topic") ?? "";
    query.addEventListener("input", filter);
    topic.addEventListener("change", filter);
    answered.addEventListener("change", filter);
    document.getElementById("search")?.addEventListener("submit", (event) => {
        event.preventDefault();
        const shown = items.filter((item) => !item.hidden);
        shown[0]?.querySelector("a")?.focus();
    });
    filter();
})();

// @ts-check
// Light or dark: as the machine says, until somebody chooses; the choice is kept where the browser allows it.
(() => {
    "use strict";
    const key = "quincunx-theme";
    const root = document.documentElement;
    const dark = window.matchMedia("(prefers-color-scheme: dark)");

    /** @returns {string | null} */
    function remembered() {
        try {
            return window.localStorage.getItem(key);
        } catch {
            return null;
        }
    }

    const chosen = remembered();
    if (chosen === "dark" || chosen === "light")
        root.dataset.theme = chosen;

    document.addEventListener("DOMContentLoaded", () => {
        const button = /** @type {HTMLButtonElement} */ (document.getElementById("theme"));
        const isDark = () => (root.dataset.theme ?? (dark.matches ? "dark" : "light")) === "dark";
        const name = () => { button.textContent = isDark() ? "Light" : "Dark"; };
        name();
        button.hidden = false;
        dark.addEventListener("change", name);
        button.addEventListener("click", () => {
            root.dataset.theme = isDark() ? "light" : "dark";
            try {
                window.localStorage.setItem(key, root.dataset.theme);
            } catch {
                // kept for this page only
            }
            name();
        });
    });
})();

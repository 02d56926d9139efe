// @ts-check
// Tables whose columns sort when their heads are pressed: numbers by value, all else as text.
(() => {
    "use strict";
    document.addEventListener("DOMContentLoaded", () => {
        for (const table of document.querySelectorAll("table.sortable"))
            for (const head of table.querySelectorAll("th"))
                head.querySelector("button")?.addEventListener("click", () => {
                    const up = head.getAttribute("aria-sort") !== "ascending";
                    for (const other of table.querySelectorAll("th"))
                        other.removeAttribute("aria-sort");
                    head.setAttribute("aria-sort", up ? "ascending" : "descending");
                    const body = /** @type {HTMLTableSectionElement} */ (table.querySelector("tbody"));
                    /** @param {HTMLTableRowElement} row */
                    const value = (row) => {
                        const cell = row.cells[head.cellIndex];
                        const text = cell?.textContent ?? "";
                        return cell?.classList.contains("num") ? Number(text) : text;
                    };
                    const rows = [...body.rows];
                    rows.sort((a, b) => {
                        const [x, y] = [value(a), value(b)];
                        return (x > y ? 1 : x < y ? -1 : 0) * (up ? 1 : -1);
                    });
                    body.append(...rows);
                });
    });
})();

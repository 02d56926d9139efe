// @ts-check
// Error against time, both logarithmic, drawn by D3: one colour and shape for each value of the first knob, the Pareto
// front in gold, and beside it the picture and the figures of the point that is pointed at or gone to with the arrow
// keys. Each element of class "chart" takes its figures from the JSON element data-NAME, as `sweep --json` prints them.
(() => {
    "use strict";

    /**
     * @typedef {{knobs: Record<string, string>, error: number | null, seconds: number, seconds_spread: number,
     *     counters: Record<string, number>, pareto: boolean}} Point
     * @typedef {{lab: string, heading: string, sweep: string, title: string, reference: string, metric: string,
     *     error_unit: string, points: Point[], pictures: string[]}} Sweep
     */

    const d3 = /** @type {any} */ (window).d3;

    /**
     * Units of the drawing: as many as there are pixels where that is little, so that letters stay readable.
     * @param {number} pixels
     */
    function sizeFor(pixels) {
        const width = Math.min(620, Math.max(320, pixels || 620));
        return {width, height: 120 + .45 * width, left: 68, right: 16, top: 14, bottom: 50};
    }

    const shapes = ["circle", "square", "diamond", "triangle-up", "cross", "triangle-down"];

    /** @param {number} value */
    const short = (value) => value === 0 ? "0" : Number(value.toPrecision(3)).toString();

    /** @param {number} index */
    const colour = (index) => `var(--series-${index % 6})`;

    /**
     * Another one where colours repeat.
     * @param {number} index
     * @param {number} area
     */
    const shape = (index, area) => d3.svg.symbol().type(shapes[(index + Math.floor(index / 6)) % 6]).size(area)();

    /**
     * Ticks of a logarithmic axis: 1, 2 and 5 of each decade where there are few, else its powers of ten.
     * @param {[number, number]} domain
     */
    function ticks([low, high]) {
        const decades = Math.log10(high / low);
        const steps = decades < 1.5 ? [1, 2, 5] : decades < 3 ? [1, 3] : [1];
        const stride = Math.max(1, Math.ceil(decades / 7));
        const values = [];
        for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power)
            for (const step of power % stride === 0 ? steps : [])
                if (step * 10 ** power >= low && step * 10 ** power <= high)
                    values.push(step * 10 ** power);
        return values;
    }

    /**
     * Powers of ten where decimals would be long.
     * @param {number} value
     */
    function label(value) {
        if (value >= 1e-3 && value < 1e5)
            return short(value);
        const power = Math.floor(Math.log10(value) + 1e-9);
        const digits = [...String(power)].map((c) => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)]).join("");
        const factor = Math.round(value / 10 ** power);
        return (factor === 1 ? "" : factor + "·") + "10" + digits;
    }

    /** @param {HTMLElement} root */
    function draw(root) {
        const source = document.getElementById("data-" + root.dataset.sweep);
        const sweep = /** @type {Sweep} */ (JSON.parse(source?.textContent ?? "null"));
        const points = sweep.points.filter((point) => point.error !== null && point.seconds > 0);
        const errors = points.map((point) => point.error ?? 0);
        const positive = errors.filter((error) => error > 0);
        if (points.length === 0)
            return;
        const plot = d3.select(root).append("div").attr("class", "chart-plot");
        const size = sizeFor(plot.node().clientWidth);
        // Zero has no place on a logarithmic axis: it is drawn below all others, and labelled so.
        const least = positive.length > 0 ? Math.min(...positive) : 1e-6;
        const floor = least / 4;
        const hasZero = positive.length < errors.length;
        const errorOf = (/** @type {Point} */ point) => (point.error ?? 0) > 0 ? point.error ?? 0 : floor;
        const times = points.map((point) => point.seconds * 1e3);
        const x = d3.scale.log().domain([Math.min(...times) / 1.4, Math.max(...times) * 1.4])
            .range([size.left, size.width - size.right]);
        const y = d3.scale.log()
            .domain([hasZero ? floor / 1.5 : least / 1.5, Math.max(...errors, floor * 2) * 1.5])
            .range([size.height - size.bottom, size.top]);

        const names = Object.keys(points[0]?.knobs ?? {});
        const seriesName = names[0] ?? "";
        const series = [...new Set(points.map((point) => point.knobs[seriesName] ?? ""))];
        const seriesOf = (/** @type {Point} */ point) => series.indexOf(point.knobs[seriesName] ?? "");
        const varying = names.filter((name) => new Set(points.map((point) => point.knobs[name])).size > 1);
        const settingOf = (/** @type {Point} */ point) =>
            varying.map((name) => `${name} ${point.knobs[name]}`).join(", ");

        const unit = sweep.error_unit ? ` (${sweep.error_unit})` : "";
        const svg = plot.append("svg").attr("viewBox", `0 0 ${size.width} ${size.height}`)
            .attr("role", "group").attr("aria-label", `${sweep.heading}: ${sweep.title}. ${sweep.metric} against time.`);

        const grid = svg.append("g").attr("class", "grid").attr("aria-hidden", "true");
        for (const tick of ticks(x.domain())) {
            grid.append("line").attr("x1", x(tick)).attr("x2", x(tick)).attr("y1", size.top).attr("y2", size.height - size.bottom);
            grid.append("text").attr("x", x(tick)).attr("y", size.height - size.bottom + 18).attr("text-anchor", "middle").text(label(tick));
        }
        for (const tick of ticks(y.domain()).filter((value) => !hasZero || value >= least / 1.2)) {
            grid.append("line").attr("x1", size.left).attr("x2", size.width - size.right).attr("y1", y(tick)).attr("y2", y(tick));
            grid.append("text").attr("x", size.left - 8).attr("y", y(tick) + 4).attr("text-anchor", "end").text(label(tick));
        }
        if (hasZero) {
            grid.append("line").attr("class", "zero").attr("x1", size.left).attr("x2", size.width - size.right).attr("y1", y(floor)).attr("y2", y(floor));
            grid.append("text").attr("x", size.left - 8).attr("y", y(floor) + 4).attr("text-anchor", "end").text("0");
        }
        grid.append("text").attr("class", "axis").attr("x", size.width - size.right).attr("y", size.height - 8)
            .attr("text-anchor", "end").text("time (ms)");
        grid.append("text").attr("class", "axis").attr("x", -size.top).attr("y", 14).attr("transform", "rotate(-90)")
            .attr("text-anchor", "end").text(sweep.metric + unit);

        const line = d3.svg.line().x((/** @type {Point} */ p) => x(p.seconds * 1e3)).y((/** @type {Point} */ p) => y(errorOf(p)));
        const front = points.filter((point) => point.pareto).sort((a, b) => a.seconds - b.seconds);
        svg.append("path").attr("class", "front").attr("d", line(front)).attr("aria-hidden", "true");
        series.forEach((name, index) => {
            const own = points.filter((point) => seriesOf(point) === index);
            svg.append("path").attr("class", "series").style("stroke", colour(index)).attr("d", line(own)).attr("aria-hidden", "true");
        });

        const side = d3.select(root).append("div").attr("class", "chart-side");
        const picture = sweep.pictures.length > 0 ? side.append("img").attr("width", 320).attr("height", 240) : null;
        const words = side.append("div").attr("class", "chart-words").attr("aria-live", "polite");
        const key = plot.append("ul").attr("class", "key");
        if (series.length > 1)
            key.append("li").attr("class", "key-name").text(seriesName);
        series.forEach((name, index) => {
            const item = key.append("li");
            item.append("svg").attr("viewBox", "-8 -8 16 16").attr("aria-hidden", "true").append("path")
                .attr("d", shape(index, 70)).style("fill", colour(index));
            item.append("span").text(name);
        });
        const frontItem = key.append("li");
        frontItem.append("svg").attr("viewBox", "-8 -8 16 16").attr("aria-hidden", "true").append("path").attr("class", "front").attr("d", "M-8,0H8");
        frontItem.append("span").text("Pareto front");

        const order = points.map((_, index) => index).sort((a, b) => (times[a] ?? 0) - (times[b] ?? 0));
        /** @type {any[]} */
        const marks = [];
        const describe = (/** @type {Point} */ point) =>
            `${settingOf(point)}: ${sweep.metric} ${short(point.error ?? 0)}${sweep.error_unit ? " " + sweep.error_unit : ""}, ` +
            `${short(point.seconds * 1e3)} ms${point.pareto ? ", on the Pareto front" : ""}`;

        /** @param {number} index */
        function choose(index) {
            const point = points[index];
            if (!point)
                return;
            marks.forEach((mark, other) => mark.classed("is-chosen", other === index).attr("tabindex", other === index ? 0 : -1));
            if (picture) {
                const file = sweep.pictures.length === 1 ? sweep.pictures[0] : sweep.pictures[sweep.points.indexOf(point)];
                picture.attr("src", file).attr("alt", `${sweep.heading} with ${settingOf(point)}`);
            }
            words.html("");
            const list = words.append("dl");
            const row = (/** @type {string} */ name, /** @type {string} */ value) => {
                list.append("dt").text(name);
                list.append("dd").text(value);
            };
            for (const name of varying)
                row(name, point.knobs[name] ?? "");
            row(sweep.metric, short(point.error ?? 0) + (sweep.error_unit ? " " + sweep.error_unit : ""));
            row("time", `${short(point.seconds * 1e3)} ± ${short(point.seconds_spread * 1e3)} ms`);
            for (const [name, count] of Object.entries(point.counters))
                row(name, count.toLocaleString("en"));
            if (point.pareto)
                words.append("p").append("span").attr("class", "tag gold").text("on the Pareto front");
        }

        points.forEach((point, index) => {
            const mark = svg.append("g").attr("class", "point" + (point.pareto ? " is-pareto" : ""))
                .attr("transform", `translate(${x(point.seconds * 1e3)},${y(errorOf(point))})`)
                .attr("role", "img").attr("aria-label", describe(point)).attr("tabindex", -1);
            mark.append("circle").attr("class", "target").attr("r", 14);
            mark.append("path").attr("d", shape(seriesOf(point), point.pareto ? 90 : 56))
                .style("fill", colour(seriesOf(point)));
            mark.on("mouseenter", () => choose(index)).on("focus", () => choose(index)).on("click", () => mark.node().focus())
                .on("keydown", () => {
                    const event = /** @type {KeyboardEvent} */ (d3.event);
                    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
                    if (step === undefined)
                        return;
                    event.preventDefault();
                    const next = order[Math.min(order.length - 1, Math.max(0, order.indexOf(index) + step))];
                    marks[next ?? index].node().focus();
                });
            marks.push(mark);
        });
        choose(points.indexOf(front[Math.floor(front.length / 2)] ?? /** @type {Point} */ (points[0])));
    }

    for (const root of document.querySelectorAll(".chart"))
        draw(/** @type {HTMLElement} */ (root));
})();

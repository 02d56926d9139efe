// @ts-check
// Compares pictures of one size: a slider or flicker between two of them, the map of their differences, zoom, and
// the values of single pixels. Takes over every element of class "compare"; without this script its figures stand
// side by side, as they do in print.
//
//   <div class="compare" data-title="bias">
//     <figure><img src="a.jpg" data-pixels="a.js" alt="…"><figcaption>none</figcaption></figure>
//     <figure><img src="b.jpg" data-pixels="b.js" alt="…"><figcaption>slope</figcaption></figure>
//     <figure class="compare-map" data-first="0" data-second="1"><img src="map.png" alt="…">
//       <figcaption>ꟻLIP 0.021</figcaption></figure>
//   </div>
//
// Browsers let no page read the pixels of a picture that is a file. `data-pixels` therefore names a script that calls
// quincunxPixels(NAME, "data:image/png;base64,…") with the lossless picture; it is loaded when somebody looks. A `src`
// that is a data URI needs none. A figure of class "compare-map" is shown as the map of its two figures; for others the
// map is computed here: the root of the mean squared difference of red, green and blue of each pixel, codes as
// code/255, in the colours of error_colours.js. `data-first` and `data-second` of the element itself choose the pair at
// the start.
(() => {
    "use strict";

    /** @type {Map<string, (uri: string) => void>} */
    const awaited = new Map();
    /** @type {Map<string, Promise<ImageData>>} */
    const known = new Map();

    const global = /** @type {any} */ (window);
    global.quincunxPixels = (/** @type {string} */ name, /** @type {string} */ uri) => awaited.get(name)?.(uri);

    /**
     * Red, green, blue of 256 steps from no difference to the largest.
     * @type {number[]}
     */
    const errorColours = global.quincunxErrorColours;

    /**
     * @template {keyof HTMLElementTagNameMap} K
     * @param {K} tag
     * @param {Record<string, string>} [attributes]
     * @param {(Node | string)[]} children
     * @returns {HTMLElementTagNameMap[K]}
     */
    function element(tag, attributes = {}, ...children) {
        const made = document.createElement(tag);
        for (const [name, value] of Object.entries(attributes))
            made.setAttribute(name, value);
        made.append(...children);
        return made;
    }

    /**
     * The data URI that a script hands over.
     * @param {string} name
     * @returns {Promise<string>}
     */
    function uriFromScript(name) {
        return new Promise((resolve, reject) => {
            awaited.set(name, resolve);
            const script = element("script", {src: name});
            script.onerror = () => reject(new Error(name + " is missing"));
            document.head.append(script);
        });
    }

    /** @param {HTMLImageElement} picture @returns {Promise<ImageData>} */
    function pixelsOf(picture) {
        const name = picture.dataset.pixels ?? picture.src;
        const load = async () => {
            const decoded = new Image();
            decoded.src = picture.dataset.pixels ? await uriFromScript(name) : name;
            await decoded.decode();
            const canvas = element("canvas");
            canvas.width = decoded.naturalWidth;
            canvas.height = decoded.naturalHeight;
            const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
            context.drawImage(decoded, 0, 0);
            return context.getImageData(0, 0, canvas.width, canvas.height);
        };
        const found = known.get(name) ?? load();
        known.set(name, found);
        return found;
    }

    /**
     * Of each pixel, and of the whole picture.
     * @param {ImageData} first
     * @param {ImageData} second
     */
    function differences(first, second) {
        const count = first.width * first.height;
        const perPixel = new Float32Array(count);
        let sum = 0;
        let largest = 0;
        let differing = 0;
        for (let i = 0; i < count; ++i) {
            let squares = 0;
            for (let c = 4 * i; c < 4 * i + 3; ++c) {
                const difference = ((first.data[c] ?? 0) - (second.data[c] ?? 0)) / 255;
                squares += difference * difference;
            }
            const value = Math.sqrt(squares / 3);
            perPixel[i] = value;
            sum += squares / 3;
            largest = Math.max(largest, value);
            differing += value > 0 ? 1 : 0;
        }
        return {perPixel, rmse: Math.sqrt(sum / count), largest, differing, count};
    }

    /** @param {ImageData} pixels @param {HTMLCanvasElement} canvas */
    function show(pixels, canvas) {
        canvas.width = pixels.width;
        canvas.height = pixels.height;
        /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")).putImageData(pixels, 0, 0);
    }

    /** @param {Float32Array} values @param {number} scale @param {HTMLCanvasElement} canvas @param {ImageData} like */
    function showMap(values, scale, canvas, like) {
        const pixels = new ImageData(like.width, like.height);
        values.forEach((value, i) => {
            const step = 3 * Math.round(255 * Math.min(1, value / scale));
            for (let c = 0; c < 3; ++c)
                pixels.data[4 * i + c] = errorColours[step + c] ?? 0;
            pixels.data[4 * i + 3] = 255;
        });
        show(pixels, canvas);
    }

    /** @param {ImageData} pixels @param {number} x @param {number} y */
    const codesAt = (pixels, x, y) => {
        const at = 4 * (y * pixels.width + x);
        return [...pixels.data.slice(at, at + 3)].join(" ");
    };

    let counter = 0;

    class Comparison {
        /** @param {HTMLElement} root */
        constructor(root) {
            this.root = root;
            const figures = /** @type {HTMLElement[]} */ ([...root.querySelectorAll("figure")]);
            const captionOf = (/** @type {HTMLElement} */ figure) =>
                figure.querySelector("figcaption")?.textContent?.trim() ?? "";
            const pictureOf = (/** @type {HTMLElement} */ figure) =>
                /** @type {HTMLImageElement} */ (figure.querySelector("img"));
            this.choices = figures.filter((figure) => !figure.classList.contains("compare-map"))
                .map((figure) => ({picture: pictureOf(figure), caption: captionOf(figure)}));
            this.maps = figures.filter((figure) => figure.classList.contains("compare-map"))
                .map((figure) => ({
                    picture: pictureOf(figure), caption: captionOf(figure),
                    first: Number(figure.dataset.first), second: Number(figure.dataset.second),
                }));
            this.first = Number(root.dataset.first ?? 0);
            this.second = Number(root.dataset.second ?? Math.min(1, this.choices.length - 1));
            this.zoom = 1;
            this.share = 50;
            this.x = -1;
            this.y = -1;
            /** @type {number | undefined} */
            this.flicker = undefined;
            this.showsSecond = false;
            /** @type {ImageData[]} */
            this.pixels = [];
            /** @type {Float32Array | undefined} */
            this.map = undefined;
            this.request = 0;

            const name = "compare-" + ++counter;
            const title = this.root.dataset.title ?? "pictures";
            this.firstCanvas = element("canvas", {"aria-hidden": "true"});
            this.secondCanvas = element("canvas", {"aria-hidden": "true", class: "compare-second"});
            this.mapCanvas = element("canvas", {"aria-hidden": "true"});
            this.divider = element("div", {class: "compare-divider", "aria-hidden": "true"});
            this.badge = element("span", {class: "compare-badge", "aria-hidden": "true"});
            this.stage = element("div", {
                class: "compare-stage", tabindex: "0", role: "application", id: name,
                "aria-label": `${title}, both pictures over one another. Arrow keys choose a pixel, plus and minus zoom.`,
            }, element("div", {class: "compare-sheet"}, this.firstCanvas, this.secondCanvas, this.divider,
                element("div", {class: "compare-cursor"})));
            this.mapStage = element("div", {
                class: "compare-stage", tabindex: "0", role: "img", "aria-label": `${title}, map of the differences`,
            }, element("div", {class: "compare-sheet"}, this.mapCanvas, element("div", {class: "compare-cursor"})));

            this.slider = element("input", {
                type: "range", min: "0", max: "100", value: "50", class: "compare-slider",
                "aria-label": `${title}: how much of the left picture is shown`,
            });
            this.slider.addEventListener("input", () => {
                this.stopFlicker();
                this.setShare(Number(this.slider.value));
            });
            this.flickerButton = element("button", {type: "button", "aria-pressed": "false"}, "Flicker");
            this.flickerButton.addEventListener("click", () => this.flicker ? this.stopFlicker() : this.startFlicker());
            this.swapButton = element("button", {type: "button", title: "Show the other picture"}, "Swap");
            this.swapButton.addEventListener("click", () => {
                this.stopFlicker();
                this.setShare(this.share > 50 ? 0 : 100);
            });
            const zoomOut = element("button", {type: "button", "aria-label": "Zoom out"}, "−");
            const zoomIn = element("button", {type: "button", "aria-label": "Zoom in"}, "+");
            zoomOut.addEventListener("click", () => this.setZoom(this.zoom / 2));
            zoomIn.addEventListener("click", () => this.setZoom(this.zoom * 2));
            this.zoomText = element("output", {class: "compare-zoom"}, "1×");
            this.readout = element("output", {class: "compare-readout"}, "Point at a pixel to read its values.");
            this.summary = element("p", {class: "compare-summary"});
            this.firstCaption = element("span");
            this.secondCaption = element("span");
            this.mapCaption = element("span");
            this.scaleBar = element("canvas", {class: "compare-scale", "aria-hidden": "true"});
            this.scaleText = element("span");

            const tools = element("div", {class: "compare-tools"});
            if (this.choices.length > 2)
                tools.append(
                    this.selector("left", this.first, (index) => { this.first = index; }),
                    this.selector("right", this.second, (index) => { this.second = index; }));
            tools.append(this.flickerButton, this.swapButton,
                element("span", {class: "compare-zooms"}, zoomOut, this.zoomText, zoomIn));

            const originals = element("div", {class: "compare-figures"});
            originals.append(...this.root.childNodes);
            const face = element("div", {class: "compare-face"},
                tools,
                element("div", {class: "compare-panels"},
                    element("div", {},
                        element("div", {class: "compare-captions", "aria-hidden": "true"}, this.firstCaption, this.secondCaption),
                        element("div", {class: "compare-frame"}, this.stage, this.badge),
                        this.slider),
                    element("div", {},
                        element("div", {class: "compare-captions"}, this.mapCaption),
                        this.mapStage,
                        element("div", {class: "compare-legend", "aria-hidden": "true"}, "0", this.scaleBar, this.scaleText))),
                this.readout, this.summary);
            this.root.append(face, originals);
            this.root.setAttribute("role", "group");
            this.root.setAttribute("aria-label", "Compare " + title);
            this.root.classList.add("is-live");

            const follow = (/** @type {HTMLElement} */ stage, /** @type {HTMLElement} */ other) => {
                stage.addEventListener("pointermove", (event) => this.point(event, stage));
                stage.addEventListener("pointerdown", (event) => this.point(event, stage));
                stage.addEventListener("keydown", (event) => this.key(event));
                stage.addEventListener("scroll", () => {
                    other.scrollLeft = stage.scrollLeft;
                    other.scrollTop = stage.scrollTop;
                });
            };
            follow(this.stage, this.mapStage);
            follow(this.mapStage, this.stage);
            this.setShare(50);
            this.load();
        }

        /** @param {string} side @param {number} chosen @param {(index: number) => void} choose */
        selector(side, chosen, choose) {
            const select = element("select");
            this.choices.forEach(({caption}, index) => {
                const option = element("option", {value: String(index)}, caption);
                option.selected = index === chosen;
                select.append(option);
            });
            select.addEventListener("change", () => {
                choose(select.selectedIndex);
                this.load();
            });
            return element("label", {}, side + " ", select);
        }

        /** Reads both pictures and shows them; the last request wins. */
        async load() {
            const request = ++this.request;
            const [first, second] = [this.choices[this.first], this.choices[this.second]];
            if (!first || !second)
                return;
            try {
                const pixels = await Promise.all([pixelsOf(first.picture), pixelsOf(second.picture)]);
                if (request === this.request)
                    await this.display(pixels, first.caption, second.caption);
            } catch (fault) {
                this.summary.textContent = "The pictures cannot be read: " + fault;
            }
        }

        /** @param {[ImageData, ImageData]} pixels @param {string} first @param {string} second */
        async display(pixels, first, second) {
            this.pixels = pixels;
            const [left, right] = pixels;
            this.root.style.setProperty("--aspect", `${left.width} / ${left.height}`);
            show(left, this.firstCanvas);
            show(right, this.secondCanvas);
            this.firstCaption.textContent = first;
            this.secondCaption.textContent = second;
            if (left.width !== right.width || left.height !== right.height) {
                this.summary.textContent = "The pictures differ in size.";
                return;
            }
            const found = differences(left, right);
            this.map = found.perPixel;
            const given = this.maps.find((map) => map.first === this.first && map.second === this.second);
            const steps = new Float32Array(256).map((_, i) => i / 255);
            showMap(steps, 1, this.scaleBar, new ImageData(256, 1));
            if (given) {
                show(await pixelsOf(given.picture), this.mapCanvas);
                this.mapCaption.textContent = given.caption;
                this.scaleText.textContent = "1";
            } else {
                const scale = Math.max(found.largest, 4 / 255);
                showMap(found.perPixel, scale, this.mapCanvas, left);
                this.mapCaption.textContent = "difference";
                this.scaleText.textContent = scale.toFixed(3);
            }
            const share = (100 * found.differing / found.count).toFixed(1);
            this.summary.textContent = found.differing === 0 ? `${first} and ${second}: the same, bit for bit.` :
                `${first} against ${second}: RMSE ${found.rmse.toFixed(4)}, ${share} % of the pixels differ, ` +
                `the most by ${found.largest.toFixed(3)}.`;
            this.tell();
            this.root.dataset.ready = "true";
        }

        /** @param {number} share */
        setShare(share) {
            this.share = Math.min(100, Math.max(0, share));
            this.showsSecond = this.share < 50;
            this.slider.value = String(this.share);
            const caption = this.choices[this.first]?.caption ?? "";
            this.slider.setAttribute("aria-valuetext", `${Math.round(this.share)} % ${caption}`);
            this.root.style.setProperty("--share", this.share + "%");
            this.badge.textContent = this.choices[this.showsSecond ? this.second : this.first]?.caption ?? "";
        }

        startFlicker() {
            this.flickerButton.setAttribute("aria-pressed", "true");
            this.root.classList.add("is-flickering");
            const flip = () => this.setShare(this.showsSecond ? 100 : 0);
            flip();
            this.flicker = window.setInterval(flip, 500);
        }

        stopFlicker() {
            window.clearInterval(this.flicker);
            this.flicker = undefined;
            this.flickerButton.setAttribute("aria-pressed", "false");
            this.root.classList.remove("is-flickering");
        }

        /**
         * Keeps the middle of the view, or the chosen pixel, where it is.
         * @param {number} zoom
         */
        setZoom(zoom) {
            const stage = this.stage;
            const width = this.pixels[0]?.width ?? 1;
            const height = this.pixels[0]?.height ?? 1;
            const before = this.zoom;
            this.zoom = Math.min(32, Math.max(1, zoom));
            const middleX = (stage.scrollLeft + stage.clientWidth / 2) / (stage.clientWidth * before);
            const middleY = (stage.scrollTop + stage.clientHeight / 2) / (stage.clientHeight * before);
            const u = this.x >= 0 ? (this.x + .5) / width : middleX;
            const v = this.x >= 0 ? (this.y + .5) / height : middleY;
            this.root.style.setProperty("--zoom", String(this.zoom));
            this.root.classList.toggle("is-zoomed", this.zoom > 1);
            stage.scrollLeft = u * stage.clientWidth * this.zoom - stage.clientWidth / 2;
            stage.scrollTop = v * stage.clientHeight * this.zoom - stage.clientHeight / 2;
            this.zoomText.textContent = this.zoom + "×";
        }

        /** @param {PointerEvent} event @param {HTMLElement} stage */
        point(event, stage) {
            const sheet = stage.firstElementChild?.getBoundingClientRect();
            const pixels = this.pixels[0];
            if (!sheet || !pixels)
                return;
            const u = (event.clientX - sheet.left) / sheet.width;
            const v = (event.clientY - sheet.top) / sheet.height;
            if (event.buttons === 1 && stage === this.stage && !this.flicker)
                this.setShare(100 * u);
            this.choose(Math.floor(u * pixels.width), Math.floor(v * pixels.height));
        }

        /** @param {KeyboardEvent} event */
        key(event) {
            const far = event.shiftKey ? 10 : 1;
            /** @type {Record<string, [number, number]>} */
            const steps = {ArrowLeft: [-far, 0], ArrowRight: [far, 0], ArrowUp: [0, -far], ArrowDown: [0, far]};
            const step = steps[event.key];
            const pixels = this.pixels[0];
            if (step && pixels) {
                const start = this.x < 0 ? [pixels.width >> 1, pixels.height >> 1] : [this.x, this.y];
                this.choose((start[0] ?? 0) + step[0], (start[1] ?? 0) + step[1]);
                this.follow();
            } else if (event.key === "+" || event.key === "=")
                this.setZoom(this.zoom * 2);
            else if (event.key === "-")
                this.setZoom(this.zoom / 2);
            else if (event.key === " ")
                this.swapButton.click();
            else
                return;
            event.preventDefault();
        }

        /** Scrolls so that the chosen pixel is seen. */
        follow() {
            const pixels = this.pixels[0];
            const stage = this.stage;
            if (!pixels || this.zoom === 1)
                return;
            stage.scrollLeft = (this.x + .5) / pixels.width * stage.clientWidth * this.zoom - stage.clientWidth / 2;
            stage.scrollTop = (this.y + .5) / pixels.height * stage.clientHeight * this.zoom - stage.clientHeight / 2;
        }

        /** @param {number} x @param {number} y */
        choose(x, y) {
            const pixels = this.pixels[0];
            if (!pixels)
                return;
            this.x = Math.min(pixels.width - 1, Math.max(0, x));
            this.y = Math.min(pixels.height - 1, Math.max(0, y));
            this.root.style.setProperty("--pixel-x", String(this.x / pixels.width));
            this.root.style.setProperty("--pixel-y", String(this.y / pixels.height));
            this.root.style.setProperty("--pixel-w", String(1 / pixels.width));
            this.root.style.setProperty("--pixel-h", String(1 / pixels.height));
            this.tell();
        }

        tell() {
            const [left, right] = this.pixels;
            if (this.x < 0 || !left || !right || !this.map)
                return;
            const difference = this.map[this.y * left.width + this.x] ?? 0;
            this.readout.textContent = `pixel ${this.x}, ${this.y}: left ${codesAt(left, this.x, this.y)}, ` +
                `right ${codesAt(right, this.x, this.y)}, difference ${difference.toFixed(3)}`;
        }
    }

    /** A comparison is made when it comes near the window, so that a page with many opens at once. */
    const watcher = new IntersectionObserver((entries) => {
        for (const entry of entries)
            if (entry.isIntersecting) {
                watcher.unobserve(entry.target);
                new Comparison(/** @type {HTMLElement} */ (entry.target));
            }
    }, {rootMargin: "200px"});
    for (const root of document.querySelectorAll(".compare"))
        watcher.observe(root);
})();

// Elements of the page.

/**
 * The element with an id, which the page has.
 * @template {Element} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function get(id, kind) {
  const element = document.getElementById(id);
  if (!(element instanceof kind)) throw new Error(`the page lacks #${id}`);
  return element;
}

/** @param {string} id */
export const button = (id) => get(id, HTMLButtonElement);

/** @param {string} id */
export const input = (id) => get(id, HTMLInputElement);

/** @param {string} id */
export const select = (id) => get(id, HTMLSelectElement);

/** @param {string} id */
export const box = (id) => get(id, HTMLElement);

/**
 * A new element.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} name
 * @param {{[name: string]: string}} attributes
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(name, attributes = {}, children = []) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/**
 * A new element of a drawing.
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} name
 * @param {{[name: string]: string | number}} attributes
 * @param {(Node | string)[]} children
 * @returns {SVGElementTagNameMap[K]}
 */
export function draw(name, attributes = {}, children = []) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.append(...children);
  return element;
}

/**
 * Sets a text only where it is another: a screen reader says again what is set again.
 * @param {Element} element
 * @param {string} text
 */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * Fills a list of choices, if it has others.
 * @param {HTMLSelectElement} list
 * @param {string[]} names
 * @param {string} chosen
 */
export function choose(list, names, chosen) {
  const all = names.includes(chosen) ? names : [...names, chosen];
  const known = [...list.options].map((option) => option.value);
  if (known.join("\n") !== all.join("\n")) {
    list.replaceChildren(...all.map((name) => make("option", { value: name }, [name])));
  }
  // Whoever is choosing is not disturbed.
  if (document.activeElement !== list || list.dataset.shown !== chosen) list.value = chosen;
  list.dataset.shown = chosen;
}

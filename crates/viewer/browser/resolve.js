// Lets node find the modules that the page shares with reports: in the browser both folders are one.

import { existsSync } from "node:fs";
import { register } from "node:module";

const SHARED = new URL("../../lab/page/", import.meta.url);

/**
 * @param {string} specifier
 * @param {{parentURL?: string}} context
 * @param {(specifier: string, context: object) => Promise<object>} next
 */
export function resolve(specifier, context, next) {
  const shared = new URL(specifier.split("/").at(-1) ?? "", SHARED);
  const isOfPage = context.parentURL?.includes("/viewer/page/") && specifier.startsWith("./");
  return next(isOfPage && existsSync(shared) ? shared.href : specifier, context);
}

if (!import.meta.url.endsWith("#hooks")) register(`${import.meta.url}#hooks`);

// Texts by their names, in the language of the page; one file a language.
import { en } from './en.js';

/** @type {Record<string, string>} */
const TEXTS = en;

/**
 * Return a text, with what stands in braces filled in.
 * @param {string} name @param {Record<string, string | number>} [values]
 */
export function t(name, values = {}) {
  const text = TEXTS[name];
  if (text === undefined) return name;
  return text.replace(/\{(\w+)\}/g, (_, key) => String(values[key] ?? ''));
}

/** A text if there is one, else the word itself, as a daemon of later says it. @param {string} family @param {string} word */
export function word(family, word) {
  return TEXTS[`${family}.${word}`] ?? word.replaceAll('_', ' ');
}

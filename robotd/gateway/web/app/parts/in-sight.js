// What was asked for far below appears at the top of a page: it is brought into sight, once, when it appears.

/** To be a `ref` of what appears. @param {Element | undefined} element */
export function inSight(element) {
  if (element !== undefined) requestAnimationFrame(() => element.scrollIntoView({ block: 'nearest' }));
}

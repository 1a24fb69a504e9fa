// The mark beside a word: told by its shape, not by its colour alone.
import { svg, html } from 'lit-html';

const SHAPES = {
  circle: svg`<circle cx="8" cy="8" r="6.5" fill="currentColor"/>`,
  ring: svg`<circle cx="8" cy="8" r="5.5" fill="none" stroke="currentColor" stroke-width="2.5" stroke-dasharray="4 2"/>`,
  diamond: svg`<path d="M8 .8 15.2 8 8 15.2.8 8Z" fill="currentColor"/>`,
  cross: svg`<path d="M3 3 13 13M13 3 3 13" stroke="currentColor" stroke-width="3.2" stroke-linecap="round"/>`,
  square: svg`<rect x="2.5" y="2.5" width="11" height="11" fill="none" stroke="currentColor" stroke-width="2.5"/>`,
};

/** @param {keyof typeof SHAPES} shape */
export const mark = (shape) => html`<svg class="mark" viewBox="0 0 16 16" aria-hidden="true">${SHAPES[shape]}</svg>`;

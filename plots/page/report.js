// SPDX-License-Identifier: BSD-3-Clause
// Search, tables that sort, and where one is.
'use strict';

(() => {
  const sections = [...document.querySelectorAll('.experiment')];
  const links = new Map([...document.querySelectorAll('#links a')].map(link => [link.hash.slice(1), link]));

  // All words must stand in what an experiment is called, asks, says, or how it is defined.
  const texts = sections.map(section =>
    [...section.querySelectorAll('h2, .asks, .says, .results, dl, pre')].map(part => part.textContent).join(' ').toLowerCase());
  element('search').addEventListener('input', event => {
    const words = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    sections.forEach((section, i) => {
      const hit = words.every(word => texts[i].includes(word));
      section.hidden = links.get(section.id).hidden = !hit;
      count += hit;
    });
    element('found').textContent = words.length ? `${count} of ${sections.length} experiments` : `${count} experiments`;
  });

  function sort(button) {
    const head = button.parentElement, column = head.cellIndex, body = head.closest('table').tBodies[0];
    const down = head.getAttribute('aria-sort') === 'ascending';
    for (const other of head.parentElement.cells) other.removeAttribute('aria-sort');
    head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    const sign = down ? -1 : 1;
    const rows = [...body.rows].map(row => {
      const text = row.cells[column].textContent;
      return { row, text, value: text === '' ? NaN : Number(text.replaceAll(',', '')) };
    });
    // What is blank comes last, whichever way.
    rows.sort((a, b) =>
      Number.isNaN(a.value) || Number.isNaN(b.value)
        ? (a.text === '') - (b.text === '') || sign * a.text.localeCompare(b.text)
        : sign * (a.value - b.value));
    body.append(...rows.map(({ row }) => row));
  }
  for (const button of document.querySelectorAll('th button')) button.addEventListener('click', () => sort(button));

  const seen = new IntersectionObserver(entries => {
    for (const { target, isIntersecting } of entries) links.get(target.id).classList.toggle('here', isIntersecting);
  }, { rootMargin: '-10% 0px -70% 0px' });
  for (const section of sections) seen.observe(section);
})();

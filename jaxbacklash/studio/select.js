// The browser's own list of choices with its label: every keyboard, screen reader and telephone knows how to use it.
export function render({model}) {
  const label = document.createElement("label")
  const words = document.createElement("span")
  const list = document.createElement("select")
  label.append(words, list)
  const offer = () => {
    words.textContent = model.label
    list.replaceChildren(...model.choices.map(([text, value]) => new Option(text, value, false, value === model.value)))
    list.value = model.value
    list.disabled = model.disabled
  }
  list.addEventListener("change", () => { model.value = list.value })
  for (const name of ["choices", "disabled", "label"]) { model.on(name, offer) }
  model.on("value", () => { list.value = model.value })
  offer()
  return label
}

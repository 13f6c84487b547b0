// A drawing that can be looked at closely: by buttons, by the keys + - 0 and the arrows, by dragging, and by Ctrl and the wheel.
export function render({model, el}) {
  const figure = document.createElement("figure")
  const bar = document.createElement("div")
  const paper = document.createElement("div")
  bar.className = "bar"
  paper.className = "paper scroll"
  paper.tabIndex = 0
  paper.setAttribute("role", "group")
  figure.append(bar, paper)
  let whole = null
  let seen = null

  const shown = () => paper.querySelector("svg")
  const set = (box) => {
    const width = Math.min(whole.width, Math.max(box.width, whole.width / 40))
    const height = width * whole.height / whole.width
    const within = (low, size, first, length) => Math.min(Math.max(low, first), first + length - size)
    seen = {x: within(box.x, width, whole.x, whole.width), y: within(box.y, height, whole.y, whole.height), width, height}
    shown().setAttribute("viewBox", `${seen.x} ${seen.y} ${seen.width} ${seen.height}`)
  }
  const zoom = (factor, x = 0.5, y = 0.5) => {
    if (!whole) { return }
    const width = seen.width * factor
    const height = seen.height * factor
    set({x: seen.x + (seen.width - width) * x, y: seen.y + (seen.height - height) * y, width, height})
  }
  const move = (x, y) => whole && set({...seen, x: seen.x + x * seen.width, y: seen.y + y * seen.height})
  const reset = () => whole && set(whole)

  for (const [sign, words, act] of [["+", "Closer", () => zoom(0.7)], ["−", "Further", () => zoom(1 / 0.7)], ["Whole", "Whole", reset]]) {
    const button = document.createElement("button")
    button.type = "button"
    button.textContent = sign
    button.dataset.does = words
    button.addEventListener("click", act)
    bar.append(button)
  }
  const keys = {
    "+": () => zoom(0.7), "=": () => zoom(0.7), "-": () => zoom(1 / 0.7), 0: reset,
    ArrowLeft: () => move(-0.1, 0), ArrowRight: () => move(0.1, 0), ArrowUp: () => move(0, -0.1), ArrowDown: () => move(0, 0.1),
  }
  paper.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) { return }
    const near = whole && seen.width < whole.width
    if (keys[event.key] && (near || !event.key.startsWith("Arrow"))) {
      keys[event.key]()
      event.preventDefault()
    }
  })
  paper.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) { return }  // the page scrolls
    const at = paper.getBoundingClientRect()
    zoom(event.deltaY < 0 ? 0.85 : 1 / 0.85, (event.clientX - at.left) / at.width, (event.clientY - at.top) / at.height)
    event.preventDefault()
  }, {passive: false})
  let from = null
  paper.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && whole && seen.width < whole.width) {
      from = event
      paper.setPointerCapture(event.pointerId)
    }
  })
  paper.addEventListener("pointermove", (event) => {
    if (!from) { return }
    const at = paper.getBoundingClientRect()
    move((from.clientX - event.clientX) / at.width, (from.clientY - event.clientY) / at.height)
    from = event
  })
  paper.addEventListener("pointerup", () => { from = null })

  const draw = () => {
    const before = seen && whole && {...seen}
    paper.innerHTML = model.svg
    const svg = shown()
    paper.setAttribute("aria-label", `${model.words} Closer with plus and minus, the whole with 0.`)
    for (const button of bar.children) { button.setAttribute("aria-label", `${button.dataset.does}: ${model.words.split(".")[0]}`) }
    figure.hidden = !svg
    if (!svg) { whole = seen = null; return }
    const box = svg.viewBox.baseVal
    const next = {x: box.x, y: box.y, width: box.width, height: box.height}
    const same = whole && next.width === whole.width && next.height === whole.height
    whole = next
    seen = {...next}
    if (same && model.stays && before) { set(before) }
  }
  for (const name of ["svg", "words"]) { model.on(name, draw) }  // they come one after the other
  draw()
  return figure
}

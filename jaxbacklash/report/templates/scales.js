// Where samples and marks lie on an axis; no drawing here.

// First sample at or after a time.
function indexAt(t, time) {
  let low = 0, high = t.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (t[middle] < time) low = middle + 1; else high = middle;
  }
  return low;
}

// Ends of an axis that holds some channels between two samples, with a margin; at least 2 * least apart.
function limits(channels, first, end, least) {
  let low = Infinity, high = -Infinity;
  for (const values of channels) {
    for (let i = first; i < end; i++) {
      const value = values[i];
      if (value === null) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) { low = -least || -1; high = least || 1; }
  const middle = (low + high) / 2, half = Math.max((high - low) / 2, least) || Math.abs(middle) || 1;
  return [middle - 1.08 * half, middle + 1.08 * half];
}

// Round values on an axis, about as many as wanted and at least two, each with its text.
function steps(low, high, wanted) {
  const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough));
  const round = [0.1, 0.2, 0.5, 1, 2, 5, 10].map((n) => n * power);
  const inside = (step) => Math.floor(high / step) - Math.ceil(low / step) + 1;
  let place = round.findIndex((step) => step >= rough * (1 - 1e-9));
  while (place > 0 && inside(round[place]) < 2) place--;
  const step = round[place];
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const marks = [];
  for (let n = Math.ceil(low / step); n * step <= high; n++) {
    const value = n * step;
    const text = decimals > 5 ? value.toExponential(2) : value.toFixed(Math.min(decimals, 10));
    marks.push([value, text.replace("-", "−")]);
  }
  return marks;
}

// A number to so many digits; a sample without one says so.
function plain(value, digits) {
  return value === null ? "none" : String(Number(value.toPrecision(digits))).replace("-", "−");
}

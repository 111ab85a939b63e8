// Arrays out of the page's text, as packing.py has packed them.

const TYPES = {
  uint8: Uint8Array,
  uint16: Uint16Array,
  uint32: Uint32Array,
  float32: Float32Array,
};

// `table`: of each array its type, its length and at which byte it begins.
export async function unpack(text, table) {
  const packed = bytes(text.trim());
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const buffer = await new Response(stream).arrayBuffer();
  const arrays = Object.entries(table).map(([name, [type, length, at]]) => [
    name,
    new TYPES[type](buffer, at, length),
  ]);
  return Object.fromEntries(arrays);
}

function bytes(text) {
  const letters = atob(text);
  const found = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k++) found[k] = letters.charCodeAt(k);
  return found;
}

// What the file carries: the certificate, byte by byte, and in it the points; or a sample of them.

const HEAD = 26; // "certreg-problem/1", a zero, n in eight bytes: the doubles begin here

/** The parsed document that was written for this script. */
export function sceneDocument() {
  return JSON.parse(document.getElementById("scene").textContent);
}

/** The bytes of the certificate's file, as they were; null where it is too large for a page. */
export async function certificateBytes() {
  const block = document.getElementById("certificate");
  if (!block) return null;
  const packed = bytesOf(block.textContent);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The bytes of the points: of the certificate, or of the sample that stands for it. */
export function pointBytes(certificate) {
  const sample = document.getElementById("sample");
  if (sample) return { bytes: bytesOf(sample.textContent), sampled: true };
  const { data } = JSON.parse(new TextDecoder().decode(certificate)).problem;
  return { bytes: bytesOf(data).slice(HEAD), sampled: false };
}

/** 32-bit floats from base64. */
export function floats(text) {
  return new Float32Array(bytesOf(text).buffer);
}

function bytesOf(text) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

/* SPDX-License-Identifier: MIT-0 */
/* The first script of a page of plgen --page unpacks what stands in the page compressed, and puts its other script into
 * the page as it was, so that the sum in the policy allows it. */
async function inflated(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
  const whole = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(whole).arrayBuffer();
}

inflated("script").then((bytes) => document.body.append(Object.assign(document.createElement("script"),
  {textContent: new TextDecoder().decode(bytes)})));

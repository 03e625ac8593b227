/** A signal that ends a request, and the reading of its answer, after a time in milliseconds. */
export function timeout(ms: number): AbortSignal {
  const controller = new AbortController(); // AbortSignal.timeout is younger than some browsers
  setTimeout(() => controller.abort(), ms);
  return controller.signal;
}

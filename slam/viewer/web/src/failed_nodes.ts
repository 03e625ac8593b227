const FIRST_WAIT_MS = 1000;
const MAX_WAIT_MS = 30_000;

/**
 * Nodes of an octree that could not be loaded. Those that the connection failed become free again
 * by themselves, each time after twice as long.
 */
export class FailedNodes {
  private readonly places = new Set<number>();
  private readonly waits = new Map<number, number>(); // milliseconds before the next attempt

  constructor(private readonly onFree: () => void) {}

  has(place: number): boolean {
    return this.places.has(place);
  }

  add(place: number, isConnection: boolean): void {
    this.places.add(place);
    if (!isConnection) return;
    const wait = this.waits.get(place) ?? FIRST_WAIT_MS;
    this.waits.set(place, Math.min(2 * wait, MAX_WAIT_MS));
    setTimeout(() => {
      if (this.places.delete(place)) this.onFree();
    }, wait);
  }

  loaded(place: number): void {
    this.waits.delete(place);
  }

  clear(): void {
    this.places.clear();
    this.waits.clear();
  }
}

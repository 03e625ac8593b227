import type { Source } from "./source";

const POLL_MS = 2000;

/** Watches whether the server answers. */
export class Connection {
  private isLost = false;
  private present: Promise<void> | null = null; // the check under way

  constructor(
    private readonly source: Source,
    private readonly onLost: () => void,
    private readonly onFound: () => void,
  ) {
    if (source.isEmbedded) return;
    setInterval(() => void this.check(), POLL_MS);
  }

  /** Asks now; after a request that failed. */
  async check(): Promise<void> {
    if (this.source.isEmbedded) return;
    this.present ??= this.ask().finally(() => (this.present = null));
    return this.present;
  }

  private async ask(): Promise<void> {
    const isAlive = await this.source.isAlive();
    if (isAlive && this.isLost) {
      this.isLost = false;
      this.onFound();
    } else if (!isAlive && !this.isLost) {
      this.isLost = true;
      this.onLost();
    }
  }
}

import { Connection } from "./connection";
import { h } from "./dom";
import { makeHelp } from "./help";
import { centerMessage, makeLayout } from "./layout";
import { LiveViewer } from "./live";
import type { Run } from "./run";
import { openSource, SourceError } from "./source";
import { Viewer } from "./viewer";
import { isForControl } from "./viewport_keys";

/** States of the page, which the style sheet and tests look at. */
type State = "loading" | "ready" | "failed";

function setState(state: State): void {
  document.body.dataset.state = state;
}

async function start(): Promise<void> {
  const page = makeLayout();
  if (document.body.dataset.mode === "live") {
    const live = new LiveViewer(page);
    document.addEventListener("keydown", (event) => {
      if (!isForControl(event) && live.key(event)) event.preventDefault();
    });
    return;
  }
  const help = makeHelp();
  const source = openSource();
  page.center.replaceChildren(
    centerMessage("Loading the run", "Poses, graph and the coarsest points come first."),
  );
  let run: Run | null = null;
  let viewer: Viewer | null = null;
  const fail = (error: Error): void => {
    setState("failed");
    page.progress.hidden = true;
    page.center.replaceChildren(
      centerMessage(
        "The run cannot be shown",
        error.message,
        h("button", { type: "button", onclick: () => location.reload() }, "Try again"),
      ),
    );
  };
  const say = (text: string | null): void => {
    page.banner.hidden = text === null;
    page.banner.textContent = text ?? "";
  };
  document.body.dataset.connection = source.isEmbedded ? "embedded" : "connected";
  const connection = new Connection(
    source,
    () => {
      document.body.dataset.connection = "lost";
      say(
        "orb360 does not answer any more. What is loaded stays; the page goes on when it is back.",
      );
    },
    () => void found(),
  );
  const found = async (): Promise<void> => {
    // Another run may be served at the same address by now.
    const now = await source.run().catch(() => null);
    if (run === null || (now !== null && JSON.stringify(now) !== JSON.stringify(run))) {
      location.reload();
      return;
    }
    document.body.dataset.connection = "connected";
    say(null);
    viewer?.reconnected();
  };
  const lostRequest = (error: Error): void => {
    if (error instanceof SourceError && error.isConnection) void connection.check();
    else say(`Some points cannot be loaded: ${error.message}`);
  };
  document.addEventListener("keydown", (event) => {
    if (isForControl(event)) return;
    if (event.key === "?") help.showModal();
    else if (!viewer?.key(event)) return;
    event.preventDefault();
  });
  try {
    run = await source.run();
    viewer = new Viewer(run, source, page, {
      onFailure: lostRequest,
      onHelp: () => help.showModal(),
    });
    page.center.replaceChildren();
    await viewer.loadCloud();
    setState("ready");
  } catch (error) {
    fail(error as Error);
  }
}

void start();

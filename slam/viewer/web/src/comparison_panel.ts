import { errorChart } from "./charts";
import { cssGradient } from "./color_maps";
import { describeAlignment, otherName } from "./comparison";
import { ERROR_MAP } from "./comparison_layer";
import { h } from "./dom";
import { length } from "./format";
import { section } from "./layout";
import type { Comparison, Run } from "./run";

interface ComparisonEvents {
  onPath: (isShown: boolean) => void;
  onCloud: (isShown: boolean) => void;
  onColor: (isByError: boolean) => void;
}

/** The section of the panel that compares a run with another path. */
export function comparisonSection(
  run: Run,
  comparison: Comparison,
  events: ComparisonEvents,
): HTMLElement {
  const legend = h(
    "div",
    { class: "legend wide", hidden: true },
    h("i", { style: `background: ${cssGradient(ERROR_MAP)}` }),
    ...[0, comparison.max / 2, comparison.max].map((value) =>
      h("span", {}, length(value, comparison.unit)),
    ),
  );
  const color = (isByError: boolean): void => {
    plain.setAttribute("aria-pressed", String(!isByError));
    byError.setAttribute("aria-pressed", String(isByError));
    legend.hidden = !isByError;
    events.onColor(isByError);
  };
  const plain = h("button", { type: "button", onclick: () => color(false) }, "One colour");
  const byError = h("button", { type: "button", onclick: () => color(true) }, "Error");
  color(false);
  const toggle = (name: string, isOn: boolean, onChange: (isOn: boolean) => void): HTMLElement =>
    h(
      "label",
      { class: "check" },
      h("input", {
        type: "checkbox",
        checked: isOn,
        onchange: (event: Event) => onChange((event.target as HTMLInputElement).checked),
      }),
      h("i", { class: "swatch other" }),
      h("span", {}, name),
    );
  const part = section(
    "Comparison",
    true,
    h("p", {}, describeAlignment(run, comparison)),
    h(
      "div",
      { class: "checks" },
      h(
        "div",
        { class: "check" },
        h("span", { class: "no-box" }),
        h("i", { class: "swatch path" }),
        h("span", {}, "This run"),
      ),
      toggle(otherName(comparison), true, events.onPath),
      run.hasCloud &&
        comparison.hasCloud &&
        toggle("Cloud of the other run", false, events.onCloud),
    ),
    h(
      "div",
      { class: "segmented", role: "group", "aria-label": "Colour of the path of this run" },
      plain,
      byError,
    ),
    legend,
    errorChart(comparison),
  );
  part.id = "comparison-section";
  return part;
}

#include "slam/evaluation/html_report.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include <opencv2/imgcodecs.hpp>

#include "slam/evaluation/chart.h"

namespace orb360 {
namespace {

constexpr std::string_view kStyle = R"(
:root { --ink: #1d2430; --soft: #667085; --line: #e4e7ec; --ground: #f7f8fa; --accent: #1f6feb; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
       font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 32px 24px 64px; }
h1 { font-size: 26px; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 17px; margin: 0 0 4px; }
p { margin: 0 0 12px; color: var(--soft); }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 12px;
         margin: 24px 0; }
.tile, section { background: #fff; border: 1px solid var(--line); border-radius: 10px; }
.tile { padding: 12px 16px; }
.tile b { display: block; font-size: 22px; font-weight: 600; }
.tile span { color: var(--soft); font-size: 13px; }
section { padding: 18px 20px; margin: 16px 0; }
img { max-width: 100%; display: block; margin: 0 auto; border-radius: 6px; }
.warning { border-left: 4px solid #d97706; }
table { border-collapse: collapse; width: 100%; }
td { padding: 5px 12px 5px 0; border-bottom: 1px solid var(--line); vertical-align: middle; }
td.name { white-space: nowrap; } td.number { text-align: right; white-space: nowrap; }
.track { position: relative; height: 12px; min-width: 200px; background: var(--ground); }
.track i { position: absolute; left: 0; top: 0; bottom: 0; background: #b6d0fa; }
.track i + i { background: var(--accent); }
)";

std::string Escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// Returns <tag>text</tag>; `tag` may have attributes.
std::string Element(const std::string& tag, const std::string& text) {
  std::string html = "<";
  html += tag;
  html += ">";
  html += Escape(text);
  html += "</";
  html += tag.substr(0, tag.find(' '));
  html += ">";
  return html;
}

std::string MakeTiles(const std::vector<HtmlReport::Tile>& tiles) {
  std::string html = "<div class=\"tiles\">\n";
  for (const HtmlReport::Tile& tile : tiles) {
    html += "<div class=\"tile\">" + Element("b", tile.value) + Element("span", tile.label) +
            "</div>\n";
  }
  return html + "</div>\n";
}

std::string MakeImage(const HtmlReport::Image& image) {
  std::string html = "<section>";
  html += Element("h2", image.title) + Element("p", image.caption);
  html += "<img alt=\"" + Escape(image.title) + "\" src=\"data:" + image.media_type + ";base64," +
          EncodeBase64(image.data) + "\"></section>\n";
  return html;
}

std::string MakeBars(const HtmlReport& report) {
  double longest = 0;
  for (const HtmlReport::Bar& bar : report.bars) longest = std::max(longest, bar.extent);
  const auto width = [longest](double value) {
    return "<i style=\"width:" + Decimal(100.0 * value / std::max(longest, 1e-9), 1) + "%\"></i>";
  };
  std::string html = "<section>";
  html += Element("h2", report.bars_title) + Element("p", report.bars_unit) + "<table>\n";
  for (const HtmlReport::Bar& bar : report.bars) {
    html += "<tr>" + Element("td class=\"name\"", bar.label) +
            Element("td class=\"number\"", Decimal(bar.value, 1)) +
            Element("td class=\"number\"", Decimal(bar.extent, 1)) +
            "<td style=\"width:70%\"><div class=\"track\">" + width(bar.extent) + width(bar.value) +
            "</div></td></tr>\n";
  }
  return html + "</table></section>\n";
}

std::string MakeTable(const HtmlReport& report) {
  std::string html = "<section>";
  html += Element("h2", report.table_title) + "<table>\n";
  for (const HtmlReport::Row& row : report.table) {
    html += "<tr>" + Element("td class=\"name\"", row.name) + Element("td", row.text) + "</tr>\n";
  }
  return html + "</table></section>\n";
}

}  // namespace

std::string EncodeBase64(const std::string& data) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((data.size() + 2) / 3 * 4);
  for (size_t i = 0; i < data.size(); i += 3) {
    std::uint32_t bits = 0;  // 24 of three bytes
    for (size_t j = 0; j < 3; ++j) {
      bits = bits << 8 | (i + j < data.size() ? static_cast<std::uint8_t>(data[i + j]) : 0u);
    }
    for (size_t j = 0; j < 4; ++j) {
      text += i + j > data.size() ? '=' : kDigits[bits >> (18 - 6 * j) & 63u];
    }
  }
  return text;
}

std::string EncodePng(const cv::Mat& image) {
  std::vector<unsigned char> png;
  cv::imencode(".png", image, png, {cv::IMWRITE_PNG_COMPRESSION, 6});
  return {png.begin(), png.end()};
}

std::string MakeHtml(const HtmlReport& report) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += Element("title", report.title);
  html += "\n<style>";
  html += kStyle;
  html += "</style></head>\n<body><main>\n";
  html += Element("h1", report.title) + Element("p", report.subtitle) + "\n";
  html += MakeTiles(report.tiles);
  for (const std::string& warning : report.warnings) {
    html += Element("section class=\"warning\"", warning) + "\n";
  }
  for (const HtmlReport::Image& image : report.images) html += MakeImage(image);
  if (!report.bars.empty()) html += MakeBars(report);
  if (!report.table.empty()) html += MakeTable(report);
  return html + "</main></body></html>\n";
}

}  // namespace orb360

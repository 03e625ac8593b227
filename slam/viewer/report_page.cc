#include "slam/viewer/report_page.h"

#include <string_view>

#include "slam/io/base64.h"
#include "slam/viewer/web_files.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// A page in a file may load nothing at all.
constexpr std::string_view kPolicy =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
    "'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action "
    "'none'\">\n";

/// Replaces what is between <!--orb360-NAME--> and <!--/orb360-NAME-->, or the first of them where
/// there is no second.
void ReplacePart(const std::string& name, const std::string& content, std::string* page) {
  const std::string begin = "<!--orb360-" + name + "-->";
  const std::string end = "<!--/orb360-" + name + "-->";
  const size_t from = page->find(begin);
  ORB360_CHECK(from != std::string::npos, name);
  const size_t to = page->find(end, from);
  const size_t length = to == std::string::npos ? begin.size() : to + end.size() - from;
  page->replace(from, length, content);
}

/// Makes JSON end no script element.
std::string EscapeJson(std::string_view json) {
  std::string escaped;
  for (const char c : json) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string DataElement(const std::string& id, const std::string& type, const std::string& text) {
  return "<script type=\"" + type + "\" id=\"embedded-" + id + "\">" + text + "</script>\n";
}

}  // namespace

std::string ReportPage(const std::string& scene_json, const std::string& octree,
                       const std::vector<EmbeddedView>& views) {
  std::string data = DataElement("run", "application/json", EscapeJson(scene_json));
  if (!octree.empty()) data += DataElement("octree", "text/plain", EncodeBase64(octree));
  for (const EmbeddedView& view : views) {
    const std::string frame = std::to_string(view.frame);
    data += DataElement("image-" + frame, "text/plain", EncodeBase64(view.image));
    data += DataElement("range-" + frame, "text/plain", EncodeBase64(view.range));
  }
  std::string page(WebPage());
  std::string head(kPolicy);
  head += "<style>";
  head += WebStyle();
  head += "</style>";
  std::string script("<script>");
  script += WebScript();
  script += "</script>";
  ReplacePart("script", script, &page);
  ReplacePart("data", data, &page);
  ReplacePart("style", head, &page);
  return page;
}

}  // namespace orb360

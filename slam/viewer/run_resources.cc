#include "slam/viewer/run_resources.h"

#include <string_view>
#include <utility>

#include "slam/io/depth_map_store.h"
#include "slam/viewer/view_files.h"
#include "slam/viewer/web_files.h"

namespace orb360 {
namespace {

constexpr int kMaxImageWidth = 4096;
constexpr int kMaxRangeWidth = 1024;

Resource OfText(std::string type, std::string_view text) {
  return {std::move(type), {}, [text] { return std::string(text); }};
}

}  // namespace

ResourceTable PageResources(bool is_live) {
  ResourceTable table;
  std::string page(WebPage());
  if (is_live) {
    const std::string mode = "data-mode=\"run\"";
    page.replace(page.find(mode), mode.size(), "data-mode=\"live\"");
  }
  table[""] = {"text/html; charset=utf-8", {}, [page] { return page; }};
  table["viewer.js"] = OfText("text/javascript; charset=utf-8", WebScript());
  table["viewer.css"] = OfText("text/css; charset=utf-8", WebStyle());
  table["alive"] = OfText("text/plain; charset=utf-8", "yes\n");
  return table;
}

ResourceTable RunResources(std::string scene_json, const std::filesystem::path& octree,
                           const RunImages& images, const std::filesystem::path& views,
                           const std::vector<int>& frames,
                           const std::filesystem::path& other_octree) {
  ResourceTable table = PageResources(false);
  table["run.json"] = {"application/json", {}, [scene = std::move(scene_json)] { return scene; }};
  const auto add_octree = [&table](const char* name, const std::filesystem::path& path) {
    if (!path.empty()) table[name] = {"application/octet-stream", path, {}};
  };
  add_octree("cloud.octree", octree);
  add_octree("other.octree", other_octree);
  for (const int frame : images.frames) {
    table["images/" + std::to_string(frame) + ".jpg"] = {
        "image/jpeg", {}, [load = images.load, frame] {
          return ImageBytes(load(frame), kMaxImageWidth);
        }};
  }
  const auto load = [views](int frame) { return DepthMapStore::Open(views).Get(frame); };
  for (const int frame : frames) {
    const std::string name = "views/" + std::to_string(frame);
    table[name + ".jpg"] = {
        "image/jpeg", {}, [load, frame] { return ImageBytes(load(frame).color, kMaxImageWidth); }};
    table[name + ".range"] = {"application/octet-stream", {}, [load, frame] {
                                return ViewRangeBytes(load(frame), kMaxRangeWidth);
                              }};
  }
  return table;
}

}  // namespace orb360

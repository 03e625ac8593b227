#include "apps/town/import/quake_shader.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "apps/town/import/lower_case.h"
#include "apps/town/import/texture_file.h"
#include "nn/base/number_text.h"

namespace orb360::town {
namespace {

/// The words of a line, in lower case. Braces are words.
using Line = std::vector<std::string>;

/// Splits a script at ends of lines and around braces, without its comments.
std::vector<Line> SplitLines(std::string_view script) {
  std::vector<Line> lines(1);
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) lines.back().push_back(LowerCase(std::exchange(word, {})));
  };
  const auto end_line = [&] {
    end_word();
    if (!lines.back().empty()) lines.emplace_back();
  };
  for (size_t i = 0; i < script.size(); ++i) {
    const std::string_view rest = script.substr(i);
    if (rest.starts_with("//")) {
      i = std::min(script.find('\n', i), script.size());
      end_line();
    } else if (rest.starts_with("/*")) {
      i = std::min(script.find("*/", i), script.size() - 1) + 1;
      end_word();
    } else if (script[i] == '\n' || script[i] == '\r') {
      end_line();
    } else if (script[i] == '{' || script[i] == '}') {
      end_line();
      lines.back().emplace_back(1, script[i]);
      end_line();
    } else if (std::isspace(static_cast<unsigned char>(script[i])) != 0 || script[i] == '"') {
      end_word();
    } else {
      word += script[i];
    }
  }
  end_line();
  lines.pop_back();  // the line that has just begun
  return lines;
}

std::string WordOf(const Line& line, size_t i) { return i < line.size() ? line[i] : ""; }

QuakeBlend BlendOf(const std::string& source, const std::string& target) {
  if (source == "add") return QuakeBlend::kAdd;
  if (source == "filter") return QuakeBlend::kFilter;
  if (source == "blend") return QuakeBlend::kAlpha;
  if (source == "gl_one" && target == "gl_zero") return QuakeBlend::kReplace;
  if (target == "gl_one_minus_src_alpha" || target == "gl_src_alpha") return QuakeBlend::kAlpha;
  if (source == "gl_dst_color" || target == "gl_src_color") return QuakeBlend::kFilter;
  return QuakeBlend::kAdd;
}

void ReadStageLine(const Line& line, QuakeStage* stage) {
  const std::string& key = line[0];
  const std::string value = WordOf(line, 1);
  if (key == "map" || key == "clampmap") {
    stage->image = value;
  } else if (key == "animmap") {  // a frequency, then images
    stage->image = WordOf(line, 2);
  } else if (key == "alphafunc") {
    stage->has_holes = true;
  } else if (key == "blendfunc") {
    stage->blend = BlendOf(value, WordOf(line, 2));
  } else if (key == "tcgen") {
    stage->is_reflection = value == "environment";
  } else if (key == "rgbgen") {
    stage->takes_vertex_light =
        value == "vertex" || value == "exactvertex" || value == "lightingdiffuse";
  } else if (key == "tcmod" && value == "scale") {
    for (size_t i = 0; i < 2; ++i)
      stage->scale[static_cast<int>(i)] = ParseNumber<float>(WordOf(line, 2 + i)).value_or(1);
    constexpr float kMax = 1000;  // tiles in a tile
    if (!stage->scale.allFinite() || stage->scale.cwiseAbs().maxCoeff() > kMax)
      stage->scale.setOnes();
  }
}

void ReadShaderLine(const Line& line, QuakeShader* shader) {
  const std::string& key = line[0];
  const std::string value = WordOf(line, 1);
  if (key == "surfaceparm") {
    shader->parameters.insert(value);
  } else if (key == "qer_editorimage") {
    shader->editor_image = value;
  } else if (key == "portal" || (key == "sort" && value == "portal")) {
    shader->is_portal = true;
  } else if (key == "skyparms") {
    shader->parameters.insert("sky");
  } else if (key == "deformvertexes" && value.starts_with("autosprite")) {
    shader->is_billboard = true;
  }
}

}  // namespace

void ParseQuakeShaders(std::string_view script, QuakeShaders* shaders) {
  std::string name;
  QuakeShader shader;
  QuakeStage stage;
  int depth = 0;  // 1 inside a shader, 2 inside a stage
  for (const Line& line : SplitLines(script)) {
    if (line[0] == "{") {
      ++depth;
      if (depth == 1) shader = {};
      if (depth == 2) stage = {};
    } else if (line[0] == "}") {
      if (depth == 2) shader.stages.push_back(stage);
      if (depth == 1 && !name.empty()) shaders->emplace(std::exchange(name, {}), shader);
      depth = std::max(depth - 1, 0);
    } else if (depth == 0) {
      name = line[0];
    } else if (depth == 1) {
      ReadShaderLine(line, &shader);
    } else {
      ReadStageLine(line, &stage);
    }
  }
}

QuakeShaders ReadQuakeShaders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (LowerExtension(entry.path()) == ".shader") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  QuakeShaders shaders;
  for (const std::filesystem::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    ParseQuakeShaders(std::string(std::istreambuf_iterator<char>(file), {}), &shaders);
  }
  return shaders;
}

}  // namespace orb360::town

#include "apps/town/import/quake_shader.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/town/import/quake_entities.h"
#include "apps/town/import/quake_surface.h"

namespace orb360::town {
namespace {

using ::testing::Contains;
using ::testing::EndsWith;

QuakeShaders Parse(const std::string& script) {
  QuakeShaders shaders;
  ParseQuakeShaders(script, &shaders);
  return shaders;
}

QuakeSurface Choose(const std::string& script, const QuakeImages& images = {},
                    const QuakeShaderName& name = {"textures/a/X"}) {
  return ChooseQuakeSurface(name, Parse(script), images);
}

TEST(QuakeShader, ParametersAndStagesAreRead) {
  const QuakeShaders shaders = Parse(
      "// a comment\n"
      "textures/A/Grate\n{\n  surfaceparm trans // why\n  qer_editorimage textures/a/e.tga\n"
      "  { map $lightmap }\n"
      "  {\n    clampMap textures/a/GRATE.tga\n    alphaFunc GE128\n    tcMod scale 2 0.5\n"
      "    blendFunc GL_DST_COLOR GL_ZERO\n  }\n"
      "  {\n    animMap 10 textures/a/f1.tga textures/a/f2.tga\n    blendfunc add\n"
      "    tcGen environment\n  }\n}\n/* all\n of this */ textures/b { surfaceparm sky }\n"
      "textures/a/grate { surfaceparm later }\ntextures/cut { surfaceparm off\n");
  ASSERT_EQ(shaders.size(), 2U);
  const QuakeShader& grate = shaders.at("textures/a/grate");
  EXPECT_THAT(grate.parameters, ::testing::ElementsAre("trans"));
  EXPECT_EQ(grate.editor_image, "textures/a/e.tga");
  ASSERT_EQ(grate.stages.size(), 3U);
  EXPECT_EQ(grate.stages[0].image, "$lightmap");
  EXPECT_EQ(grate.stages[1].image, "textures/a/grate.tga");
  EXPECT_TRUE(grate.stages[1].has_holes);
  EXPECT_EQ(grate.stages[1].blend, QuakeBlend::kFilter);
  EXPECT_EQ(grate.stages[1].scale, Eigen::Vector2f(2, 0.5F));
  EXPECT_EQ(grate.stages[2].image, "textures/a/f1.tga");
  EXPECT_EQ(grate.stages[2].blend, QuakeBlend::kAdd);
  EXPECT_TRUE(grate.stages[2].is_reflection);
  EXPECT_THAT(shaders.at("textures/b").parameters, Contains("sky"));
}

TEST(QuakeShader, AnyTextIsRead) {
  for (const char* text : {"", "}", "{", "}}}{{{", "a {", "a { {", "/*", "//", "a { { map } }",
                           "a { { tcmod scale x } }", "{ {{{ map a } } }", "\"", "a\n{\n}\n}\n"})
    Parse(text);
  EXPECT_EQ(Parse("a { { tcmod scale nan 1e30\nmap b } }").at("a").stages[0].scale,
            Eigen::Vector2f::Ones());
}

TEST(QuakeSurface, TheFirstImageOfItsOwnIsShown) {
  const QuakeImages images = {{"textures/a/x", "game/textures/a/x.jpg"},
                              {"textures/a/base", "game/textures/a/base.tga"}};
  EXPECT_THAT(Choose("", images).material.texture, EndsWith("game/textures/a/x.jpg"));
  EXPECT_TRUE(Choose("", images).material.is_opaque);
  const std::string script =
      "textures/a/x { { map textures/a/env.tga\n tcGen environment }\n { map $lightmap\n"
      "blendfunc filter } { map textures/a/base.jpg\n blendfunc filter } }";
  EXPECT_THAT(Choose(script, images).material.texture, EndsWith("game/textures/a/base.tga"));
  EXPECT_TRUE(Choose(script, images).is_lit);
  // Without that image, the one of the surface's own name.
  EXPECT_THAT(Choose("textures/a/x { { map textures/a/none.tga } }", images).material.texture,
              EndsWith("game/textures/a/x.jpg"));
  EXPECT_FALSE(Choose("textures/a/x { { map textures/a/x.tga } }", images).is_lit);
}

TEST(QuakeSurface, WhatNobodySeesIsHidden) {
  EXPECT_TRUE(Choose("").is_shown);
  for (const char* parameter : {"sky", "nodraw", "fog"})
    EXPECT_FALSE(Choose("textures/a/x { surfaceparm " + std::string(parameter) + " }").is_shown);
  EXPECT_FALSE(Choose("textures/a/x { portal\n }").is_shown);
  EXPECT_FALSE(Choose("textures/a/x { deformVertexes autosprite\n }").is_shown);
  EXPECT_FALSE(Choose("", {}, {"textures/a/x", QuakeBits::kSky}).is_shown);
  EXPECT_FALSE(Choose("", {}, {"textures/common/caulk"}).is_shown);
  EXPECT_FALSE(Choose("", {}, {"noshader"}).is_shown);
  // A beam of light, and the same as water.
  const std::string glow = "{ map a.tga\n blendfunc add } }";
  EXPECT_FALSE(Choose("textures/a/x { " + glow).is_shown);
  const QuakeSurface water = Choose("textures/a/x { surfaceparm water\n " + glow);
  EXPECT_TRUE(water.is_shown && water.material.is_liquid && water.material.is_opaque);
  const QuakeSurface grate = Choose("textures/a/x { { map a.tga\n alphafunc ge128 } }");
  EXPECT_TRUE(grate.is_shown && !grate.material.is_opaque);
}

TEST(QuakeEntities, GroupsOfKeysAndValuesAreRead) {
  const std::vector<QuakeEntity> entities = ParseQuakeEntities(
      "{\n\"classname\" \"worldspawn\"\n\"message\" \"a {brace} inside\"\n}\n"
      "{\n\"classname\" \"light\"\n\"origin\" \"1 -2 3.5\"\n\"origin\" \"7 7 7\"\n}\n{ \"cut\" \"");
  ASSERT_EQ(entities.size(), 2U);
  EXPECT_EQ(ValueOf(entities[0], "message"), "a {brace} inside");
  EXPECT_EQ(ValueOf(entities[0], "none"), "");
  EXPECT_EQ(VectorOf(entities[1], "origin"), Eigen::Vector3f(1, -2, 3.5F));
  EXPECT_FALSE(VectorOf(entities[1], "classname"));
  for (const char* text : {"", "{", "}", "{ \"", "{ \"a\" }", "{ \"a\" \"b\"", "\"a\" \"b\""})
    EXPECT_TRUE(ParseQuakeEntities(text).empty()) << text;
}

}  // namespace
}  // namespace orb360::town

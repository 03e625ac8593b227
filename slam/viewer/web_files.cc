#include "slam/viewer/web_files.h"

// The assembler copies the files into the object file. A C++ array of this size would take the
// compiler seconds.
#define ORB360_EMBED(name, file)             \
  asm(".pushsection .rodata\n"               \
      ".global orb360_web_" #name            \
      "\n"                                   \
      "orb360_web_" #name                    \
      ":\n"                                  \
      ".incbin \"" ORB360_WEB_DIR "/" file   \
      "\"\n"                                 \
      ".global orb360_web_" #name            \
      "_end\n"                               \
      "orb360_web_" #name                    \
      "_end:\n"                              \
      ".byte 0\n"                            \
      ".popsection\n");                      \
  extern "C" const char orb360_web_##name[]; \
  extern "C" const char orb360_web_##name##_end[]

ORB360_EMBED(page, "index.html");
ORB360_EMBED(script, "viewer.js");
ORB360_EMBED(style, "viewer.css");

namespace orb360 {

std::string_view WebPage() { return {orb360_web_page, orb360_web_page_end}; }
std::string_view WebScript() { return {orb360_web_script, orb360_web_script_end}; }
std::string_view WebStyle() { return {orb360_web_style, orb360_web_style_end}; }

}  // namespace orb360

#pragma once

#include <string_view>

namespace orb360 {

/// The files of the page, which were compiled into the program (slam/viewer/web/dist).
std::string_view WebPage();    ///< index.html
std::string_view WebScript();  ///< viewer.js
std::string_view WebStyle();   ///< viewer.css

}  // namespace orb360

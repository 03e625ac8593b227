#pragma once

#include <string>
#include <string_view>

namespace orb360 {

/// Encodes bytes as base64 (RFC 4648).
std::string EncodeBase64(std::string_view data);

}  // namespace orb360

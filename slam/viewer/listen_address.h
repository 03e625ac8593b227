#pragma once

#include <string>

namespace orb360 {

/// Throws UserError, with the option that helps (`port_option`, such as `--port N`), where nothing
/// can listen at the address and port: the port is taken or reserved, or the address is not one of
/// this machine.
void RequireFree(const std::string& address, int port, const std::string& port_option);

}  // namespace orb360

// SPDX-License-Identifier: GPL-2.0-or-later
// A sentence from its parts.
#pragma once

#include <sstream>
#include <string>

namespace yade {

template <class... Parts> std::string text(const Parts&... parts) {
    std::ostringstream out;
    (out << ... << parts);
    return out.str();
}

} // namespace yade

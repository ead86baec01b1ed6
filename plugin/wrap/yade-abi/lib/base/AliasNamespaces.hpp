// SPDX-License-Identifier: GPL-2.0-or-later
// Short names that plugin sources use inside namespace yade.
#pragma once

namespace boost {
namespace python {}
} // namespace boost

namespace yade {
namespace py = ::boost::python;
}

// SPDX-License-Identifier: GPL-2.0-or-later
// YADE's 3D view, opened before our classes were there.
#pragma once

#include <boost/python.hpp>

namespace ancf {

// Makes the tables anew by which a view (yade.qt.Renderer()) finds how a shape is drawn: it is as long as there were
// shapes when yade.qt was imported, and one of ours behind its end would abort.
void refreshView(const boost::python::object& renderer);

} // namespace ancf

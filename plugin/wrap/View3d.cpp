// SPDX-License-Identifier: GPL-2.0-or-later
#include "View3d.hpp"

#include <pkg/common/OpenGLRenderer.hpp>

namespace yade {

namespace {
    void empty(vector<string>& names) { names.clear(); }
    template <class Table> void empty(Table& table) { table.functors.clear(); }
} // namespace

// Its tables are private in YADE; an explicit instantiation may name what is.
template <auto... table> struct Tables {
    friend void emptyTables(OpenGLRenderer& view) { (empty(view.*table), ...); }
};
void emptyTables(OpenGLRenderer& view);
template struct Tables<&OpenGLRenderer::boundDispatcher, &OpenGLRenderer::geomDispatcher,
                       &OpenGLRenderer::physDispatcher, &OpenGLRenderer::shapeDispatcher,
                       &OpenGLRenderer::boundFunctorNames, &OpenGLRenderer::shapeFunctorNames,
                       &OpenGLRenderer::geomFunctorNames, &OpenGLRenderer::physFunctorNames>;

} // namespace yade

void ancf::refreshView(const boost::python::object& renderer) {
    yade::OpenGLRenderer& view = boost::python::extract<yade::OpenGLRenderer&>(renderer)();
    emptyTables(view);
    view.init();
}

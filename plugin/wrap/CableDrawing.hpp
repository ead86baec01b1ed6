// SPDX-License-Identifier: GPL-2.0-or-later
// Cables in YADE's 3D view.
#pragma once

#include "CableElement.hpp"

#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class Gl1_CableElement : public GlShapeFunctor {
public:
    // Settings of all: the view makes its own object.
    static Real fullTension;
    static int parts;

    void go(const shared_ptr<Shape>&, const shared_ptr<State>&, bool, const GLViewInfo&) override;
    RENDERS(CableElement)
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Gl1_CableElement, GlShapeFunctor,
        "Draws a :yref:`CableElement` as a tube of its true diameter along its curve, and as a line, which can be seen from "
        "afar; blue where it is slack, through yellow to red at the largest tension.",
        ,
        ,
        .add_static_property("fullTension", py::make_getter(&Gl1_CableElement::fullTension), py::make_setter(&Gl1_CableElement::fullTension))
        .add_static_property("parts", py::make_getter(&Gl1_CableElement::parts), py::make_setter(&Gl1_CableElement::parts))
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(Gl1_CableElement);

} // namespace yade

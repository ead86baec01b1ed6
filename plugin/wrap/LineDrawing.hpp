// SPDX-License-Identifier: GPL-2.0-or-later
// Lines in YADE's 3D view.
#pragma once

#include <pkg/common/OpenGLRenderer.hpp>

namespace yade {

class GlExtra_Lines : public GlExtraDrawer {
public:
    void render() override;
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(GlExtra_Lines, GlExtraDrawer,
        "Draws the lines of the scene (:yref:`LineEngine`) as tubes of their true diameter from place to place, coloured as "
        "cables are, and their rings; in qt.Renderer().extraDrawers of a view that knows ancf.",
        ,
        ,
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(GlExtra_Lines);

} // namespace yade

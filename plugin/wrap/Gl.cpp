// SPDX-License-Identifier: GPL-2.0-or-later
#include "Gl.hpp"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace yade {

namespace {
    template <class F> void load(F& function, void* library, const char* name) {
        function = reinterpret_cast<F>(dlsym(library, name));
        if (!function) throw std::runtime_error(std::string("ancf, 3D view: libGL.so.1 has no ") + name);
    }
} // namespace

Gl::Gl() {
    void* library = dlopen("libGL.so.1", RTLD_LAZY | RTLD_GLOBAL);
    if (!library) throw std::runtime_error("ancf, 3D view: there is no libGL.so.1");
    load(begin, library, "glBegin");
    load(end, library, "glEnd");
    load(normal, library, "glNormal3f");
    load(vertex, library, "glVertex3f");
    load(color, library, "glColor3f");
    load(enable, library, "glEnable");
    load(disable, library, "glDisable");
    load(lineWidth, library, "glLineWidth");
}

const Gl& Gl::calls() {
    static const Gl loaded;
    return loaded;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
// OpenGL's calls, looked up where there is a picture to draw: the plugin does not need the library otherwise.
#pragma once

namespace yade {

struct Gl {
    enum { lines = 1, lineStrip = 3, triangleStrip = 5, lighting = 0x0B50 };
    void (*begin)(unsigned);
    void (*end)();
    void (*normal)(float, float, float);
    void (*vertex)(float, float, float);
    void (*color)(float, float, float);
    void (*enable)(unsigned);
    void (*disable)(unsigned);
    void (*lineWidth)(float);

    // RuntimeError in Python where there is no OpenGL.
    static const Gl& calls();

private:
    Gl();
};

} // namespace yade

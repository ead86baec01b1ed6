// SPDX-License-Identifier: GPL-2.0-or-later
// A scene with cables: its engines, their order, and the functors for what can meet. Never asks Python, as a step does.
#pragma once

#include <core/Scene.hpp>

#include <cstdint>

namespace yade {

class InteractionLoop;

class SceneCheck {
    const Scene& scene;

    void order() const;
    void once() const;
    void drives() const;
    void collider() const;
    bool cablesFeelBodies() const;
    void pair(const InteractionLoop& loop, const Body& a, const Body& b) const;

public:
    explicit SceneCheck(const Scene& s) : scene(s) {}

    void engines() const;  // runtime_error for what is missing, twice, dead or in the wrong place; warns
    void functors() const; // runtime_error for pairs of bodies that would pass through each other or end YADE; warns

    // A number of all that engines() and functors() depend on besides the bodies: another one if any of it has changed.
    uint64_t print() const;
};

// "body 3 (CableElement 0, HollarsMat 'cable')"
string fullName(const Body& body);

// A UserWarning of Python if this thread has its lock, else a line on the terminal.
void warn(const string& text);

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "Sheave.hpp"

#include "Gl.hpp"
#include "text.hpp"

#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <cmath>
#include <sstream>

namespace yade {

YADE_PLUGIN((Sheave)(Bo1_Sheave_Aabb)(Ig2_Sheave_Sphere_ScGeom)(Gl1_Sheave))

namespace {
    [[noreturn]] void refuse(const char* attribute, Real value, const string& rule) {
        std::ostringstream text;
        text << "Sheave." << attribute << " = " << value << ": " << rule;
        throw std::invalid_argument(text.str());
    }

    ancf_groove roundGroove(const Sheave& s) {
        const Real fillet = s.grooveRadius > 0 ? s.grooveRadius : s.width / 2;
        if (fillet < s.width / 2 * (1 - 1e-9))
            refuse("grooveRadius", fillet,
                   "must be at least width/2 in a round groove; a narrower one is profile='vee'");
        const Real slope = std::asin(std::min(1., s.width / 2 / fillet)), arc = fillet * (1 - std::cos(slope));
        // Walls, if any, go straight out from the end of the arc.
        return {s.radius, 0, fillet, slope, std::max(arc, s.flangeHeight), 0};
    }

    ancf_groove flatGroove(const Sheave& s) {
        if (s.flangeHeight == 0) return {s.radius, s.width / 2, 0, M_PI / 2, 0, 0};
        const Real fillet = s.grooveRadius > 0 ? s.grooveRadius : std::min(s.flangeHeight, s.width / 4);
        if (fillet > s.width / 2 || fillet > s.flangeHeight)
            refuse("grooveRadius", fillet, "must be at most width/2 and flangeHeight on a flat sheave");
        return {s.radius, s.width / 2 - fillet, fillet, M_PI / 2, s.flangeHeight, 0};
    }

    ancf_groove veeGroove(const Sheave& s) {
        const Real fillet = s.grooveRadius > 0 ? s.grooveRadius : s.width / 6, slope = (M_PI - s.grooveAngle) / 2;
        const Real wall = s.width / 2 - fillet * std::sin(slope);
        if (wall < 0) refuse("grooveRadius", fillet, "is too large for the width of this vee");
        return {s.radius, 0, fillet, slope, fillet * (1 - std::cos(slope)) + wall * std::tan(slope), 0};
    }
} // namespace

namespace {
    bool same(const ancf_groove& a, const ancf_groove& b) {
        return a.radius == b.radius && a.floor == b.floor && a.fillet == b.fillet && a.slope == b.slope &&
               a.height == b.height && a.land == b.land;
    }

    // What lies on it would be inside it, or off it.
    void checkUntouched(const Sheave& sheave, bool otherRadius) {
        const auto scene = Omega::instance().getScene();
        for (const auto& body : *scene->bodies) {
            if (!body || body->shape.get() != &sheave) continue;
            for (const auto& [id, contact] : body->intrs)
                if (contact->isReal())
                    throw std::invalid_argument(
                        text("Sheave.", otherRadius ? text("radius = ", sheave.radius) : "profile and sizes", ": body ",
                             body->id, " is in contact with body ", id, ": change it before they touch"));
        }
    }
} // namespace

void Sheave::postLoad(Sheave&) {
    const auto need = [](bool good, const char* name, Real value, const char* rule) {
        if (!good) refuse(name, value, rule);
    };
    constexpr Real most = 1e9;
    need(radius > 0 && radius <= most, "radius", radius, "must be above zero and at most 1e9 [m]");
    need(width > 0 && width <= most, "width", width, "must be above zero and at most 1e9 [m]");
    need(grooveAngle > 0 && grooveAngle < M_PI, "grooveAngle", grooveAngle, "must be between 0 and pi");
    for (const auto& [name, value] : {std::pair("grooveRadius", grooveRadius), std::pair("flangeHeight", flangeHeight),
                                      std::pair("flangeThickness", flangeThickness)})
        need(value >= 0 && value <= most, name, value, "must be from zero to 1e9 [m]");
    ancf_groove made;
    if (profile == "round") made = roundGroove(*this);
    else if (profile == "flat") made = flatGroove(*this);
    else if (profile == "vee") made = veeGroove(*this);
    else throw std::invalid_argument("Sheave.profile = '" + profile + "': must be 'round', 'flat' or 'vee'");
    if (made.height > 0) made.land = flangeThickness > 0 ? flangeThickness : width / 4;
    const ancf_error error = ancf_groove_check(&made);
    if (error) throw std::invalid_argument(string("Sheave: ") + ancf_error_text(error));
    if (form.radius > 0 && !same(made, form)) checkUntouched(*this, made.radius != form.radius);
    form = made;
}

Vector3r Sheave::axisOf(const Quaternionr& ori) {
    Vector3r axis = ori * Vector3r::UnitZ();
    for (int i = 0; i < 3; ++i)
        if (std::abs(axis[i]) < 1e-9) axis[i] = 0;
    return axis.normalized();
}

py::tuple Sheave::touch(const Vector3r& place, Real ballRadius) const {
    if (!std::isfinite(place.sum()) || !(ballRadius >= 0 && std::isfinite(ballRadius)))
        throw std::invalid_argument("Sheave.touch: place and radius must be finite, the radius not below 0 [m]");
    const Vector3r axis = Vector3r::UnitZ();
    ancf_groove_contact found;
    ancf_groove_touch(&found, &form, axis.data(), place.data(), ballRadius);
    return py::make_tuple(found.depth, Vector3r(found.normal[0], found.normal[1], found.normal[2]));
}

vector<Vector2r> Sheave::outline() const {
    constexpr int arcParts = 8;
    vector<Vector2r> right {{form.floor, form.radius}}; // from the middle out
    for (int i = 1; i <= arcParts && form.height > 0; ++i) {
        const Real a = form.slope * i / arcParts;
        right.emplace_back(form.floor + form.fillet * std::sin(a), form.radius + form.fillet * (1 - std::cos(a)));
    }
    right.emplace_back(opening() / 2, rimRadius());
    right.emplace_back(overallWidth() / 2, rimRadius());
    right.emplace_back(overallWidth() / 2, 0);
    vector<Vector2r> all;
    for (auto p = right.rbegin(); p != right.rend(); ++p) all.emplace_back(-p->x(), p->y());
    all.insert(all.end(), right.begin(), right.end());
    return all;
}

py::list Sheave::pyOutline() const {
    py::list places;
    for (const Vector2r& p : outline()) places.append(p);
    return places;
}

void Bo1_Sheave_Aabb::go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r& se3, const Body*) {
    const auto& sheave = static_cast<const Sheave&>(*shape);
    if (!bound) bound = shared_ptr<Bound>(new Aabb);
    const Vector3r axis = Sheave::axisOf(se3.orientation);
    Vector3r half;
    for (int i = 0; i < 3; ++i)
        half[i] = sheave.rimRadius() * std::sqrt(std::max(0., 1 - axis[i] * axis[i])) +
                  sheave.overallWidth() / 2 * std::abs(axis[i]);
    bound->min = se3.position - half;
    bound->max = se3.position + half;
}

bool Ig2_Sheave_Sphere_ScGeom::go(const shared_ptr<Shape>& shape1, const shared_ptr<Shape>& shape2, const State& state1,
                                  const State& state2, const Vector3r& shift2, const bool& force,
                                  const shared_ptr<Interaction>& contact) {
    const auto& sheave = static_cast<const Sheave&>(*shape1);
    const Real radius = static_cast<const Sphere&>(*shape2).radius;
    const Vector3r axis = Sheave::axisOf(state1.ori), place = state2.pos + shift2 - state1.pos;
    ancf_groove_contact found;
    ancf_groove_touch(&found, &sheave.groove(), axis.data(), place.data(), radius);
    if (found.depth < 0 && !contact->isReal() && !force) return false;
    const bool fresh = !contact->geom;
    if (fresh) contact->geom = shared_ptr<ScGeom>(new ScGeom);
    auto& geom = static_cast<ScGeom&>(*contact->geom);
    const Vector3r normal(found.normal[0], found.normal[1], found.normal[2]);
    geom.radius1 = sheave.radius;
    geom.radius2 = radius;
    geom.penetrationDepth = found.depth;
    geom.contactPoint = state2.pos + shift2 - (radius - found.depth / 2) * normal;
    geom.precompute(state1, state2, scene, contact, normal, fresh, shift2, false);
    return true;
}

void Gl1_Sheave::go(const shared_ptr<Shape>& shape, const shared_ptr<State>&, bool wire, const GLViewInfo&) {
    const Gl& gl = Gl::calls();
    constexpr int parts = 48;
    const auto& sheave = static_cast<const Sheave&>(*shape);
    const auto line = sheave.outline();
    gl.color(sheave.color[0], sheave.color[1], sheave.color[2]);
    for (size_t k = 0; k + 1 < line.size(); ++k) {
        const float z0 = line[k][0], r0 = line[k][1], z1 = line[k + 1][0], r1 = line[k + 1][1];
        const float dz = z1 - z0, dr = r1 - r0, length = std::hypot(dz, dr);
        if (length == 0) continue;
        gl.begin(wire || shape->wire ? Gl::lineStrip : Gl::triangleStrip);
        for (int i = 0; i <= parts; ++i) {
            const float c = std::cos(2 * M_PI * i / parts), s = std::sin(2 * M_PI * i / parts);
            gl.normal(c * dz / length, s * dz / length, -dr / length);
            gl.vertex(r1 * c, r1 * s, z1); // first, so that faces look outwards: others are not drawn
            gl.vertex(r0 * c, r0 * s, z0);
        }
        gl.end();
    }
    gl.color(0, 0, 0); // the mark
    gl.begin(Gl::lines);
    const float side = 1.01 * sheave.overallWidth() / 2;
    for (const float z : {-side, side}) {
        gl.vertex(0, 0, z);
        gl.vertex(sheave.rimRadius(), 0, z);
    }
    gl.end();
}

} // namespace yade

#include "ancf/rest.h"

#include "ancf/lying.h"
#include "internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FOUND_MAX = 65, STEPS_HELD = 50 };

struct near_solid {
    int element, obstacle;
};

struct ancf_rest {
    const ancf_cover* cover;
    const ancf_laws* laws;
    int kinds;
    ancf_obstacle* obstacle;
    int n_obstacles;
    const ancf_obstacle_pair* pair;
    int n_pairs;
    ancf_boxes* boxes;
    bool boxed; // once
    int n_near, room_near;
    struct near_solid* near;
    double *force, *inertia, *drag; // (3 x stride)
    double leap;                    // [m]
    const double* rate;             // (3 x stride) of the state
};

ancf_error ancf_rest_create(ancf_rest** rest, const ancf_model* m, const ancf_cover* cover, const ancf_laws* laws,
                            int kinds, ancf_obstacle* obstacle, int n_obstacles, const ancf_obstacle_pair* pair,
                            int n_pairs) {
    ancf_rest* r = *rest = calloc(1, sizeof *r);
    if (!r) return ANCF_E_MEMORY;
    *r = (ancf_rest) {.cover = cover,
                      .laws = laws,
                      .kinds = kinds,
                      .obstacle = obstacle,
                      .n_obstacles = n_obstacles,
                      .pair = pair,
                      .n_pairs = n_pairs,
                      .leap = INFINITY};
    r->force = calloc(3 * (size_t)m->stride, sizeof *r->force);
    r->inertia = calloc(3 * (size_t)m->stride, sizeof *r->inertia);
    r->drag = calloc(3 * (size_t)m->stride, sizeof *r->drag);
    if (!r->force || !r->inertia || !r->drag || ancf_boxes_create(&r->boxes, m, cover)) {
        ancf_rest_destroy(r);
        *rest = NULL;
        return ANCF_E_MEMORY;
    }
    for (int e = 0; e < m->n_elements; ++e)
        if (cover[e].radius > 0.0) r->leap = fmin(r->leap, 0.25 * cover[e].radius);
    for (int i = 0; i < n_pairs; ++i) r->leap = fmin(r->leap, 0.25 * obstacle[pair[i].ball].solid.size[0]);
    return ANCF_OK;
}

void ancf_rest_destroy(ancf_rest* r) {
    if (!r) return;
    ancf_boxes_destroy(r->boxes);
    free(r->near);
    free(r->force);
    free(r->inertia);
    free(r->drag);
    free(r);
}

const double* ancf_rest_force(const ancf_rest* r) { return r->force; }

const double* ancf_rest_inertia(const ancf_rest* r) { return r->inertia; }

double ancf_rest_leap(const ancf_rest* r) { return r->leap; }

const double* ancf_rest_drag(const ancf_rest* r) { return r->drag; }

// ---------------------------------------------------------------- what may touch

static void place_obstacle(ancf_obstacle* o, const ancf_model* m) {
    if (o->node < 0) return;
    for (int c = 0; c < 3; ++c) {
        const double center = m->x[c * m->stride + o->node] + o->arm[c];
        for (int k = 0; k < 3; ++k) o->solid.corner[k][c] += center - o->solid.center[c];
        o->solid.center[c] = center;
    }
}

static bool excluded(const ancf_obstacle* o, int element) {
    int low = 0, high = o->n_excluded;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (o->excluded[middle] < element) low = middle + 1;
        else high = middle;
    }
    return low < o->n_excluded && o->excluded[low] == element;
}

// A signed distance changes by no more than the way: what is not inside a ball around a box is not inside the box.
static bool reaches(const ancf_obstacle* o, const ancf_box* box, double room) {
    double center[3], normal[3], square = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double half = 0.5 * (box->high[c] - box->low[c]);
        center[c] = box->low[c] + half;
        square += half * half;
    }
    return ancf_solid_distance(normal, &o->solid, center) <= sqrt(square) + room;
}

static bool add_near(ancf_rest* r, int element, int obstacle) {
    if (r->n_near == r->room_near) {
        const int room = r->room_near ? 2 * r->room_near : 64;
        struct near_solid* grown = realloc(r->near, (size_t)room * sizeof *grown);
        if (!grown) return false;
        r->near = grown;
        r->room_near = room;
    }
    r->near[r->n_near++] = (struct near_solid) {element, obstacle};
    return true;
}

// How far a node may move while the boxes hold, along one axis and so with all three.
static double room_of(const ancf_rest* r, const ancf_model* m, int node) {
    double room = INFINITY;
    for (int k = m->first[node]; k < m->first[node + 1]; ++k)
        room = fmin(room, ancf_boxes_room(r->boxes, m->at[k] >> 1));
    return isfinite(room) ? sqrt(3.0) * room : 0.0;
}

static bool find_near(ancf_rest* r, const ancf_model* m) {
    r->n_near = 0;
    for (int i = 0; i < r->n_obstacles; ++i) place_obstacle(&r->obstacle[i], m);
    for (int e = 0; e < m->n_elements; ++e) {
        if (r->cover[e].radius == 0.0) continue;
        ancf_box box;
        ancf_boxes_of(&box, r->boxes, m, e);
        for (int i = 0; i < r->n_obstacles; ++i) {
            const ancf_obstacle* o = &r->obstacle[i];
            if (!(o->mask & r->cover[e].mask) || excluded(o, e)) continue;
            const double room = o->node < 0 ? 0.0 : room_of(r, m, o->node);
            if (reaches(o, &box, room) && !add_near(r, e, i)) return false;
        }
    }
    return true;
}

// Boxes with room for so many changes by `rate`, and what is near them. False: out of memory.
static bool set_boxes(ancf_rest* r, ancf_model* m, double* rate, int steps) {
    double* velocity = m->v;
    m->v = rate;
    ancf_boxes_plan(r->boxes, m, 1.0, steps, 0.0);
    m->v = velocity;
    return ancf_boxes_set(r->boxes, m) >= 0 && find_near(r, m);
}

static int count_pairs(const ancf_rest* r) {
    int meetings;
    ancf_boxes_meetings(r->boxes, &meetings);
    return meetings + r->n_near + r->n_pairs;
}

int ancf_rest_look(ancf_rest* r, ancf_model* m, double* rate) {
    if (!r->boxed || !ancf_boxes_hold(r->boxes, m)) {
        if (!set_boxes(r, m, rate, STEPS_HELD)) return -1;
        r->boxed = true;
    }
    return count_pairs(r);
}

bool ancf_rest_clear(ancf_rest* r, ancf_model* m, double* way) {
    r->boxed = false;
    return set_boxes(r, m, way, 1) && count_pairs(r) == 0;
}

// ---------------------------------------------------------------- forces

// A force along a normal, what it gains by a way along it and across, and what damps its two sides against each other.
typedef struct {
    double normal[3], force, along, across, drag; // [N], [N/m], drag as force
} pressing;

// As row sums of the stiffness, in the units of fictitious masses (equilibrium.c).
static void add_row(ancf_rest* r, const ancf_model* m, int dof, double weight, double unit, double sum,
                    const pressing* p) {
    const double all = fabs(p->normal[0]) + fabs(p->normal[1]) + fabs(p->normal[2]);
    for (int c = 0; c < 3; ++c) {
        const int j = c * m->stride + dof;
        r->force[j] += weight * p->force * p->normal[c];
        r->drag[j] += weight * p->drag * p->normal[c];
        r->inertia[j] += fabs(weight) * unit * sum * (p->along * fabs(p->normal[c]) * all + p->across);
    }
}

static void press_place(ancf_rest* r, const ancf_model* m, int element, double xi, const pressing* p) {
    double S[4], sum = 0.0;
    int dof[4];
    ancf_model_weights(S, m, element, xi);
    ancf_model_dofs(dof, m, element);
    const double length = m->element[element].length, unit[4] = {1.0, length, 1.0, length};
    for (int i = 0; i < 4; ++i) sum += fabs(S[i]) / unit[i];
    for (int i = 0; i < 4; ++i) add_row(r, m, dof[i], S[i], unit[i], sum, p);
}

// What acts on a cable or ball at a point acts on the obstacle, and so on the node that carries it.
static void press_obstacle(ancf_rest* r, const ancf_model* m, ancf_obstacle* o, const double at[3], pressing p) {
    p.force = -p.force;
    p.drag = -p.drag;
    for (int c = 0; c < 3; ++c) {
        const int j = (c + 1) % 3, k = (c + 2) % 3;
        o->force[c] += p.force * p.normal[c];
        o->moment[c] += p.force * (at[j] * p.normal[k] - at[k] * p.normal[j]);
    }
    if (o->node >= 0) add_row(r, m, o->node, 1.0, 1.0, 1.0, &p);
}

static pressing pressing_of(const ancf_normal* law, const double normal[3], double depth, double part, double radius) {
    const double force = part * ancf_normal_force(law, depth, 0.0);
    pressing p = {.force = force, .along = part * ancf_normal_tangent(law, depth), .across = force / radius};
    memcpy(p.normal, normal, sizeof p.normal);
    return p;
}

// Velocity of a place, or of a node, along a normal.
static double rate_at(const ancf_rest* r, const ancf_model* m, int element, double xi, const double normal[3]) {
    double v[3];
    ancf_model_at(v, m, r->rate, element, xi);
    return v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2];
}

static double rate_of(const ancf_rest* r, const ancf_model* m, int node, const double normal[3]) {
    double sum = 0.0;
    for (int c = 0; c < 3 && node >= 0; ++c) sum += r->rate[c * m->stride + node] * normal[c];
    return sum;
}

// The side of a contact that a segment of an element meets: a solid, or another element.
typedef struct {
    ancf_obstacle* o;        // or NULL
    int element;             // the other one
    const ancf_cubic* cubic; // its own
    const ancf_cover* cover;
    const ancf_normal* law;
} side;

static void press_place_and_side(ancf_rest* r, const ancf_model* m, int element, double xi, const double at[3],
                                 const side* s, double eta, pressing p) {
    const double rate = s->o ? rate_of(r, m, s->o->node, p.normal) : rate_at(r, m, s->element, eta, p.normal);
    p.drag = -p.along * (rate_at(r, m, element, xi, p.normal) - rate);
    if (!s->o || s->o->node >= 0) p.along *= 2.0; // both sides give way
    press_place(r, m, element, xi, &p);
    if (s->o) {
        press_obstacle(r, m, s->o, at, p);
        return;
    }
    p.force = -p.force;
    p.drag = -p.drag;
    press_place(r, m, s->element, eta, &p);
}

// Depth and normal at a point of the centreline.
static void probe(ancf_spot* s, const ancf_rest* r, const ancf_model* m, int element, const side* other) {
    const ancf_cover* cover = &r->cover[element];
    if (other->o) {
        s->depth = fmax(cover->radius - ancf_solid_distance(s->normal, &other->o->solid, s->at), 0.0);
        return;
    }
    ancf_nearest_pair found;
    ancf_cubic point;
    for (int k = 0; k < 4; ++k) memcpy(point.control[k], s->at, sizeof s->at);
    s->depth = 0.0;
    if (!ancf_nearest_cubic(&found, &point, 1, cover->radius, other->cubic, other->cover->radius, 0.0)) return;
    if (ancf_cross_neighbours(cover, s->xi, m->element[element].length, other->cover, found.xi[1],
                              m->element[other->element].length))
        return;
    s->eta = found.xi[1];
    s->depth = -found.gap;
    memcpy(s->normal, found.normal, sizeof s->normal);
}

// spot: the deepest place of the segment comes first; room for the others.
static void press_segment(ancf_rest* r, const ancf_model* m, int element, const ancf_cubic* cubic, int segment,
                          ancf_spot spot[ANCF_LYING_SPOTS], const side* other) {
    const ancf_cover* cover = &r->cover[element];
    double spread;
    ancf_lying_along(spot, segment, cover->segments);
    for (int i = 1; i < ANCF_LYING_SPOTS; ++i) {
        ancf_cubic_at(spot[i].at, cubic, spot[i].xi);
        probe(&spot[i], r, m, element, other);
    }
    const double depth = ancf_lying_depth(spot, &spread);
    // what second derivatives of the one depth add to the stiffness, at most
    double stiffer = spread == 0.0 ? 1.0 : spread < 1.0 ? 4.0 : 2.0;
    if (spot[1].part > 0.0) stiffer += 4.0;
    for (int i = 0; i < ANCF_LYING_SPOTS; ++i) {
        const ancf_spot* s = &spot[i];
        if (s->part <= 0.0) continue;
        pressing p = pressing_of(other->law, s->normal, depth, s->part, cover->radius);
        p.along *= stiffer;
        press_place_and_side(r, m, element, s->xi, s->at, other, s->eta, p);
    }
}

static void press_points(ancf_rest* r, const ancf_model* m, int element, const ancf_cubic* cubic, const side* other) {
    ancf_nearest found[FOUND_MAX];
    const ancf_cover* cover = &r->cover[element];
    const int n = ancf_cover_touch(found, cover, cubic, &other->o->solid, 0.0);
    for (int i = 0; i < n; ++i) {
        const pressing p = pressing_of(other->law, found[i].normal, -found[i].gap, 1.0, cover->radius);
        press_place_and_side(r, m, element, found[i].xi, found[i].point, other, 0.0, p);
    }
}

static ancf_spot spot_of(double xi, double eta, double gap, const double at[3], const double normal[3]) {
    ancf_spot s = {.xi = xi, .eta = eta, .depth = -gap};
    memcpy(s.at, at, sizeof s.at);
    memcpy(s.normal, normal, sizeof s.normal);
    return s;
}

static void press_solid(ancf_rest* r, const ancf_model* m, const struct near_solid* near) {
    ancf_nearest found[FOUND_MAX];
    ancf_cubic cubic;
    const ancf_cover* cover = &r->cover[near->element];
    side other = {.o = &r->obstacle[near->obstacle]};
    other.law = &other.o->law[cover->kind];
    ancf_cover_cubic(&cubic, m, m->x, near->element);
    if (cover->points) {
        press_points(r, m, near->element, &cubic, &other);
        return;
    }
    const int n = ancf_nearest_solid(found, &cubic, cover->segments, cover->radius, &other.o->solid, 0.0);
    for (int i = 0; i < n; ++i) {
        ancf_spot spot[ANCF_LYING_SPOTS];
        spot[0] = spot_of(found[i].xi, 0.0, found[i].gap, found[i].point, found[i].normal);
        press_segment(r, m, near->element, &cubic, found[i].segment, spot, &other);
    }
}

static void press_ball(ancf_rest* r, const ancf_model* m, const ancf_obstacle_pair* pair) {
    ancf_obstacle *ball = &r->obstacle[pair->ball], *o = &r->obstacle[pair->other];
    const double radius = ball->solid.size[0];
    double normal[3], point[3];
    const double gap = ancf_solid_distance(normal, &o->solid, ball->solid.center) - radius;
    if (gap >= 0.0) return;
    pressing p = pressing_of(&pair->law, normal, -gap, 1.0, radius);
    p.drag = -p.along * (rate_of(r, m, ball->node, normal) - rate_of(r, m, o->node, normal));
    if (o->node >= 0) p.along *= 2.0;
    for (int c = 0; c < 3; ++c) point[c] = ball->solid.center[c] - (radius + 0.5 * gap) * normal[c];
    press_obstacle(r, m, o, point, p);
    p.force = -p.force; // from the other's side
    p.drag = -p.drag;
    press_obstacle(r, m, ball, point, p);
}

static void press_cables(ancf_rest* r, const ancf_model* m, const ancf_meeting* pair) {
    ancf_nearest_pair found[FOUND_MAX];
    ancf_cubic cubic[2];
    const int e = pair->first, f = pair->second;
    const ancf_cover *first = &r->cover[e], *second = &r->cover[f];
    ancf_cover_cubic(&cubic[0], m, m->x, e);
    ancf_cover_cubic(&cubic[1], m, m->x, f);
    const side other = {.element = f,
                        .cubic = &cubic[1],
                        .cover = second,
                        .law = &r->laws[first->kind * r->kinds + second->kind].normal};
    const int n = ancf_nearest_cubic(found, &cubic[0], first->segments, first->radius, &cubic[1], second->radius, 0.0);
    for (int i = 0; i < n; ++i) {
        const ancf_nearest_pair* at = &found[i];
        if (ancf_cross_neighbours(first, at->xi[0], m->element[e].length, second, at->xi[1], m->element[f].length))
            continue;
        ancf_spot spot[ANCF_LYING_SPOTS];
        spot[0] = spot_of(at->xi[0], at->xi[1], at->gap, at->point[0], at->normal);
        press_segment(r, m, e, &cubic[0], at->segment, spot, &other);
    }
}

void ancf_rest_press(ancf_rest* r, const ancf_model* m, const double* rate) {
    const size_t field = 3 * (size_t)m->stride * sizeof(double);
    memset(r->force, 0, field);
    memset(r->inertia, 0, field);
    memset(r->drag, 0, field);
    r->rate = rate;
    for (int i = 0; i < r->n_obstacles; ++i) {
        ancf_obstacle* o = &r->obstacle[i];
        place_obstacle(o, m);
        for (int c = 0; c < 3; ++c) o->force[c] = o->moment[c] = 0.0;
    }
    for (int i = 0; i < r->n_near; ++i) press_solid(r, m, &r->near[i]);
    for (int i = 0; i < r->n_pairs; ++i) press_ball(r, m, &r->pair[i]);
    int meetings;
    const ancf_meeting* meeting = ancf_boxes_meetings(r->boxes, &meetings);
    for (int i = 0; i < meetings; ++i) press_cables(r, m, &meeting[i]);
    ancf_model_join(m, r->force);
    ancf_model_join(m, r->inertia);
    ancf_model_join(m, r->drag);
}

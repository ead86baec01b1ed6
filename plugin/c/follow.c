// Contacts go on into the next step of the cable: what is near was found once, where it touches is found anew from
// where it was.
#include "ancf/cover.h"
#include "ancf/lying.h"
#include "internal.h"
#include "lever.h"
#include "table.h"

#include <math.h>

// Where a side is at the start of the step, and how fast.
typedef struct {
    double x[3], v[3];
} motion;

static motion motion_of(const ancf_table* t, const ancf_side* side, const ancf_model* m) {
    motion at = {{0.0}, {0.0}};
    if (side->place >= 0) {
        const ancf_place* p = &t->place[side->place];
        ancf_value_of(at.x, p->dof, p->S, m, m->x);
        ancf_value_of(at.v, p->dof, p->S, m, m->v);
    } else if (side->body >= 0) {
        const ancf_body* b = &t->body[side->body];
        for (int k = 0; k < 3; k++) {
            at.x[k] = b->position[k] + b->moved[k];
            at.v[k] = b->velocity[k];
        }
    }
    return at;
}

static void put(ancf_place* p, const ancf_model* m, double xi, bool slope) {
    p->xi = xi;
    ancf_model_weights(p->S, m, p->element, xi);
    if (slope) ancf_model_slope_weights(p->T, m, p->element, xi);
}

// Where a segment is held by a ball in the middle of the step.
static void slide_on_ball(ancf_table* t, ancf_contact* c, const ancf_model* m, const ancf_cubic* cubic, double step) {
    ancf_place* p = &t->place[c->side[0].place];
    const motion ball = motion_of(t, &c->side[1], m);
    ancf_solid solid = {.kind = ANCF_BALL, .size = {c->round}};
    const int segments = (int)(1.0 / (c->within[1] - c->within[0]) + 0.5);
    for (int k = 0; k < 3; k++) solid.center[k] = ball.x[k] + 0.5 * step * ball.v[k];
    ancf_nearest near;
    ancf_nearest_place(&near, (int)(c->within[0] * segments + 0.5), ancf_nearest_from(cubic, c->within, solid.center),
                       cubic, 0.0, &solid);
    double v[3], opening = 0.0;
    ancf_model_at(v, m, m->v, p->element, near.xi);
    for (int k = 0; k < 3; k++) opening += near.normal[k] * (v[k] - ball.v[k]);
    ancf_lying_on(&near, cubic, segments, 0.0, &solid, ancf_larger(-0.5 * step * opening, 0.0));
    p->xi = near.xi;
    ancf_model_mean_weights(p->S, m, p->element, near.power);
    c->law = ancf_normal_shared(&c->plain, near.share);
    double way[3];
    for (int k = 0; k < 3; k++) way[k] = near.point[k] - solid.center[k];
    c->held = sqrt(ancf_dot(way, way)) - near.gap;
}

// Places that are nearest to each other in the middle of the step.
static void slide(ancf_table* t, ancf_contact* c, const ancf_model* m, double step) {
    ancf_cubic first, second;
    ancf_place* p = &t->place[c->side[0].place];
    ancf_cover_ahead(&first, m, p->element, 0.5 * step);
    if (c->radius[0] == 0.0) {
        slide_on_ball(t, c, m, &first, step);
        return;
    }
    ancf_place* q = &t->place[c->side[1].place];
    double xi[2] = {p->xi, q->xi};
    ancf_cover_ahead(&second, m, q->element, 0.5 * step);
    if (!ancf_nearest_settle(xi, &first, c->within, &second)) return;
    put(p, m, xi[0], ancf_lever_has(c));
    put(q, m, xi[1], ancf_lever_has(c));
}

// Normal in the middle of the step, gap at its start.
static void look_again(ancf_contact* c, const motion* first, const motion* second, double step) {
    const double radii = c->radius[0] > 0.0 ? c->radius[0] + c->radius[1] : c->held;
    double way[3], opening = 0.0;
    for (int k = 0; k < 3; k++) way[k] = first->x[k] - second->x[k] + 0.5 * step * (first->v[k] - second->v[k]);
    const double along = ancf_dot(way, c->normal), distance = copysign(sqrt(ancf_dot(way, way)), along);
    for (int k = 0; k < 3; k++) {
        if (along != 0.0) c->normal[k] = way[k] / distance;
        opening += c->normal[k] * (first->v[k] - second->v[k]);
    }
    c->gap = distance - radii - 0.5 * step * opening;
}

static bool is_round(const ancf_contact* c) { return c->radius[0] > 0.0 || c->round > 0.0; }

// Part of a step's move by which it may be longer than at the speeds of its start.
static const double spare = 1.25;

// Whether it is too far to touch in the step, however it moves.
static bool too_far(const ancf_contact* c, const motion* first, const motion* second, double step) {
    const double *v = first->v, *u = second->v;
    return c->gap > spare * step * (sqrt(ancf_dot(v, v)) + sqrt(ancf_dot(u, u))) + c->margin;
}

// Velocity with which two sides come together along the normal.
static double approach(const ancf_table* t, const ancf_contact* c, const ancf_model* m, const double* velocity) {
    double sum = 0.0, v[3];
    for (int s = 0; s < 2; ++s) {
        const ancf_side* side = &c->side[s];
        const double sign = s ? 1.0 : -1.0;
        if (side->place >= 0) {
            const ancf_place* p = &t->place[side->place];
            ancf_value_of(v, p->dof, p->S, m, velocity);
            sum += sign * ancf_dot(v, c->normal);
        }
        if (side->body >= 0) {
            ancf_body_velocity(v, &t->body[side->body], side->arm);
            sum += sign * ancf_dot(v, c->normal);
        }
    }
    return sum;
}

// Leaves out what cannot touch in the step. What is apart forgets friction.
static void leave_out(ancf_table* t, const ancf_model* m, const double* velocity, double step, bool flat) {
    for (int i = 0; i < t->n_contacts; ++i) {
        ancf_contact* c = &t->contact[i];
        c->idle = (flat || is_round(c)) && c->gap > c->margin &&
                  c->gap > c->margin + spare * step * approach(t, c, m, velocity);
        for (int k = 0; k < 3 && c->idle; k++) c->friction[k] = 0.0;
    }
    for (int i = 0; i < t->n_places; ++i) t->place[i].idle = true;
    for (int i = 0; i < t->n_contacts; ++i)
        for (int s = 0; s < 2; ++s)
            if (!t->contact[i].idle && t->contact[i].side[s].place >= 0)
                t->place[t->contact[i].side[s].place].idle = false;
    for (int i = 0; i < t->n_couplings; ++i) t->place[t->coupling[i].place].idle = false;
}

void ancf_table_rest(ancf_table* t, const ancf_model* m, const double* velocity, double step, double passed) {
    t->passed = passed;
    leave_out(t, m, velocity, step, passed == 0.0);
}

static void follow(ancf_table* t, ancf_contact* c, const ancf_model* m, double step) {
    const bool carried = c->side[0].body >= 0, slides = c->radius[0] > 0.0 || c->within[0] < c->within[1];
    motion first = motion_of(t, &c->side[0], m), second = motion_of(t, &c->side[1], m);
    if (is_round(c)) {
        look_again(c, &first, &second, step);
        if (!carried && slides && !too_far(c, &first, &second, step)) {
            slide(t, c, m, step);
            first = motion_of(t, &c->side[0], m);
            second = motion_of(t, &c->side[1], m);
            look_again(c, &first, &second, step);
        }
    } else {
        c->gap += step * (ancf_table_opening(t, c) - c->speed); // friction, which came last, has moved it too
    }
    double* out = c->side[0].arm; // to the surface of what is carried
    const double size = sqrt(ancf_dot(out, out));
    for (int k = 0; k < 3; k++) {
        if (is_round(c) && carried) out[k] = -size * c->normal[k];
        c->side[1].arm[k] = first.x[k] + (carried ? out[k] : 0.0) - second.x[k];
    }
}

ancf_error ancf_table_go_on(ancf_table* t, const ancf_model* m, const double* velocity, double step) {
    t->passed += step;
    ancf_table_accelerate(t, m, m->a); // where contacts were
    for (int i = 0; i < t->n_contacts; ++i) {
        ancf_contact* c = &t->contact[i];
        if (!c->idle) c->owed = ancf_owed(c->owed, c->late, c->changing);
        follow(t, c, m, step);
    }
    for (int i = 0; i < t->n_bodies; ++i)
        for (int k = 0; k < 3; k++) {
            t->body[i].velocity[k] += step * t->body[i].given[k];
            t->body[i].spin[k] += step * t->body[i].given[3 + k];
        }
    for (int i = 0; t->slopes && i < t->n_places; ++i) {
        ancf_place* p = &t->place[i];
        ancf_value_of(p->slope, p->dof, p->T, m, m->x);
    }
    leave_out(t, m, velocity, step, false);
    const ancf_error error = ancf_table_start(t, m, velocity);
    if (!error) ancf_table_accelerate(t, m, m->a);
    return error;
}

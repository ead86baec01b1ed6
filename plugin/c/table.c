#include "table.h"

#include "ancf/shape.h"
#include "factor.h"
#include "internal.h"
#include "lever.h"
#include "slide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

ancf_error ancf_table_create(ancf_table** table, const ancf_model* m) {
    ancf_table* t = *table = calloc(1, sizeof *t);
    if (!t) return ANCF_E_MEMORY;
    t->head = calloc((size_t)m->n_dof, sizeof *t->head);
    ancf_error error = t->head ? ancf_responses_create(&t->responses, m) : ANCF_E_MEMORY;
    if (error) {
        ancf_table_destroy(t);
        *table = NULL;
        return error;
    }
    for (int i = 0; i < m->n_dof; ++i) t->head[i] = -1;
    t->slides = -1;
    return ANCF_OK;
}

void ancf_table_destroy(ancf_table* t) {
    if (!t) return;
    ancf_responses_destroy(t->responses);
    free(t->place);
    free(t->body);
    free(t->contact);
    free(t->coupling);
    free(t->first);
    free(t->other);
    free(t->effect);
    free(t->bend);
    free(t->head);
    free(t->next);
    free(t->sum);
    free(t->touched);
    free(t->stiffness);
    free(t->scratch);
    free(t->hold);
    free(t->slip);
    free(t->push);
    free(t->drag);
    free(t->rubbing);
    free(t->part);
    free(t->first_on);
    free(t->next_on);
    free(t->effects);
    ancf_groups_free(&t->groups);
    ancf_knots_factor_free(&t->knots);
    free(t);
}

void ancf_table_renew(ancf_table* t, const ancf_model* m, int node) { ancf_responses_renew(t->responses, m, node); }

void ancf_table_clear(ancf_table* t) {
    t->n_places = t->n_bodies = t->n_contacts = t->n_couplings = 0;
    t->slopes = false;
    t->slides = -1;
    t->passed = 0.0;
}

static int add(void** items, int* n, int* room, const void* item, size_t size) {
    if (!ancf_reserve(items, room, *n + 1 < 16 ? 16 : *n + 1, size)) return -1;
    memcpy((char*)*items + (size_t)*n * size, item, size);
    return (*n)++;
}

void ancf_value_of(double value[3], const int dof[4], const double weight[4], const ancf_model* m,
                   const double* field) {
    for (int c = 0; c < 3; c++) {
        const double* u = field + c * m->stride;
        value[c] = weight[0] * u[dof[0]] + weight[1] * u[dof[1]] + weight[2] * u[dof[2]] + weight[3] * u[dof[3]];
    }
}

int ancf_table_add_mean(ancf_table* t, const ancf_model* m, int element, const double power[3]) {
    ancf_place p = {.element = element, .xi = power[0]};
    ancf_model_dofs(p.dof, m, element);
    ancf_model_mean_weights(p.S, m, element, power);
    p.response = ancf_responses_of(t->responses, m, element);
    if (!p.response) return -1;
    return add((void**)&t->place, &t->n_places, &t->room_places, &p, sizeof p);
}

int ancf_table_add_place(ancf_table* t, const ancf_model* m, int element, double xi) {
    double power[3];
    ancf_powers(power, xi);
    return ancf_table_add_mean(t, m, element, power);
}

int ancf_table_add_slope(ancf_table* t, const ancf_model* m, int element, double xi) {
    const int i = ancf_table_add_place(t, m, element, xi);
    if (i < 0) return i;
    ancf_place* p = &t->place[i];
    ancf_model_slope_weights(p->T, m, element, xi);
    ancf_value_of(p->slope, p->dof, p->T, m, m->x);
    t->slopes = true;
    return i;
}

int ancf_table_add_knot(ancf_table* t, const ancf_model* m, int node) {
    int k = m->first[node];
    while (m->element[m->at[k] >> 1].kind & ANCF_WOUND && k + 1 < m->first[node + 1]) ++k;
    const int end = m->at[k];
    return ancf_table_add_place(t, m, end >> 1, end & 1);
}

int ancf_table_add_body(ancf_table* t, const ancf_body* body) {
    const int i = add((void**)&t->body, &t->n_bodies, &t->room_bodies, body, sizeof *body);
    if (i < 0) return i;
    ancf_body* b = &t->body[i];
    b->work = 0.0;
    for (int c = 0; c < 3; c++) {
        b->impulse[c] = b->twist[c] = b->shift[c] = b->turn[c] = b->moved[c] = b->turned[c] = 0.0;
        b->given[c] = b->acceleration[c];
        b->given[3 + c] = b->turning[c];
    }
    return i;
}

int ancf_table_add_contact(ancf_table* t, const ancf_contact* contact) {
    return add((void**)&t->contact, &t->n_contacts, &t->room_contacts, contact, sizeof *contact);
}

int ancf_table_add_coupling(ancf_table* t, const ancf_coupling* coupling) {
    return add((void**)&t->coupling, &t->n_couplings, &t->room_couplings, coupling, sizeof *coupling);
}

int ancf_table_contacts(const ancf_table* t) { return t->n_contacts; }
int ancf_table_awake(const ancf_table* t) { return t->groups.contacts; }
int ancf_table_places(const ancf_table* t) { return t->n_places; }
ancf_place* ancf_table_place(ancf_table* t, int i) { return &t->place[i]; }
void ancf_table_twist_left(double twist[3], const ancf_table* t) { memcpy(twist, t->left, sizeof t->left); }
ancf_body* ancf_table_body(ancf_table* t, int i) { return &t->body[i]; }
ancf_contact* ancf_table_contact(ancf_table* t, int i) { return &t->contact[i]; }
ancf_coupling* ancf_table_coupling(ancf_table* t, int i) { return &t->coupling[i]; }

// Velocity of unknown response->dof[k] by a unit impulse with weights at the place.
static double answer(const ancf_place* p, const double weight[4], int k) {
    const double* column = p->response->column[k];
    return column[0] * weight[0] + column[1] * weight[1] + column[2] * weight[2] + column[3] * weight[3];
}

// What an impulse at place i does to all others: along its response, to every place that uses an unknown of it.
static int find_effects(ancf_table* t, int i) {
    const ancf_place* p = &t->place[i];
    int n = 0;
    for (int k = 0; k < p->response->n; ++k) {
        int use = t->head[p->response->dof[k]];
        if (use < 0) continue;
        const double dv = answer(p, p->S, k), du = t->slopes ? answer(p, p->T, k) : 0.0;
        for (; use >= 0; use = t->next[use]) {
            const int j = use >> 2;
            const double S = t->place[j].S[use & 3], T = t->place[j].T[use & 3];
            ancf_effects* sum = &t->sum[j];
            if (sum->effect == 0.0) t->touched[n++] = j;
            sum->effect += dv * S;
            sum->bend.to += dv * T;
            sum->bend.from += du * S;
            sum->bend.both += du * T;
            if (sum->effect == 0.0) sum->effect = 1e-300; // stays on the list
        }
    }
    return n;
}

static bool make_room(ancf_table* t) {
    const int n = t->n_places;
    return ancf_reserve((void**)&t->first, &t->room_first, n + 1, sizeof *t->first) &&
           ancf_reserve((void**)&t->next, &t->room_next, 4 * n, sizeof *t->next) &&
           ancf_reserve((void**)&t->stiffness, &t->room_stiffness, n + t->n_bodies, sizeof *t->stiffness) &&
           ancf_reserve((void**)&t->scratch, &t->room_scratch, 9 * t->n_couplings, sizeof *t->scratch) &&
           ancf_reserve((void**)&t->push, &t->room_push, t->n_contacts, sizeof *t->push) &&
           ancf_reserve((void**)&t->drag, &t->room_drag, t->n_contacts, sizeof *t->drag) &&
           ancf_reserve((void**)&t->rubbing, &t->room_rubbing, t->n_contacts, sizeof *t->rubbing) &&
           ancf_reserve((void**)&t->part, &t->room_part, t->n_contacts + 1, sizeof *t->part) &&
           ancf_reserve((void**)&t->first_on, &t->room_first_on, t->n_bodies, sizeof *t->first_on) &&
           ancf_reserve((void**)&t->next_on, &t->room_next_on, t->n_contacts, sizeof *t->next_on) &&
           ancf_reserve((void**)&t->effects, &t->room_effects, t->n_contacts,
                        4 * ANCF_NEWTON_MOST * sizeof *t->effects) &&
           ancf_reserve((void**)&t->slip, &t->room_slip, t->n_contacts, sizeof *t->slip);
}

static bool make_sums(ancf_table* t) {
    if (t->n_places <= t->room_sum) return true;
    int room = t->room_sum;
    if (!ancf_reserve((void**)&t->touched, &room, t->n_places, sizeof *t->touched) ||
        !ancf_reserve((void**)&t->sum, &t->room_sum, t->n_places, sizeof *t->sum))
        return false;
    memset(t->sum, 0, (size_t)t->room_sum * sizeof *t->sum);
    return true;
}

// Of a knot on itself.
static double own_effect(const ancf_place* p) {
    double sum = 0.0;
    for (int k = 0; k < p->response->n && k < 2; ++k) // an element's own nodes come first
        for (int i = 0; i < 4; ++i)
            if (p->dof[i] == p->response->dof[k]) sum += p->S[i] * answer(p, p->S, k);
    return sum;
}

// A solve goes through a few times as many entries as there are rows, places through up to all of one another.
static bool factor_is_faster(const ancf_table* t) {
    const ancf_mass* mass = t->model->mass;
    return mass->diagonal || (long)t->n_couplings * t->n_couplings > 4L * mass->n;
}

static bool any_contact(const ancf_table* t) {
    for (int i = 0; i < t->n_contacts; ++i)
        if (!t->contact[i].idle) return true;
    return false;
}

// Rows of `effect`, each in the order in which its places were met.
static ancf_error make_effects(ancf_table* t) {
    int count = 0;
    t->first[0] = 0;
    t->factored = t->n_couplings > 0 && t->slides < 0 && factor_is_faster(t);
    t->alone = t->factored && !any_contact(t);
    for (int i = 0; i < t->n_places; ++i) {
        const int n = t->place[i].idle || t->alone ? 0 : find_effects(t, i);
        if (t->alone && !t->place[i].idle) t->place[i].compliance = own_effect(&t->place[i]);
        int room[2] = {t->room_effect, t->room_effect};
        if (!ancf_reserve((void**)&t->other, &room[0], count + n, sizeof *t->other) ||
            !ancf_reserve((void**)&t->bend, &room[1], count + n, sizeof *t->bend) ||
            !ancf_reserve((void**)&t->effect, &t->room_effect, count + n, sizeof *t->effect)) {
            for (int k = 0; k < n; ++k) t->sum[t->touched[k]] = (ancf_effects) {0};
            return ANCF_E_MEMORY;
        }
        for (int k = 0; k < n; ++k, ++count) {
            const int j = t->touched[k];
            t->other[count] = j;
            t->effect[count] = t->sum[j].effect;
            t->bend[count] = t->sum[j].bend;
            if (j == i) t->place[i].compliance = t->sum[j].effect;
            t->sum[j] = (ancf_effects) {0};
        }
        t->first[i + 1] = count;
    }
    return ANCF_OK;
}

static void list_uses(ancf_table* t) {
    for (int i = t->n_places - 1; i >= 0; --i)
        for (int k = 3; k >= 0; --k) {
            if (t->place[i].idle || (t->place[i].S[k] == 0.0 && t->place[i].T[k] == 0.0)) {
                t->next[4 * i + k] = -1;
                continue;
            }
            int* head = &t->head[t->place[i].dof[k]];
            t->next[4 * i + k] = *head;
            *head = 4 * i + k;
        }
}

static void forget_uses(ancf_table* t) {
    for (int i = 0; i < t->n_places; ++i)
        for (int k = 0; k < 4; ++k) t->head[t->place[i].dof[k]] = -1;
}

static void start_place(ancf_table* t, ancf_place* p, const ancf_model* m, const double* velocity) {
    ancf_value_of(p->velocity, p->dof, p->S, m, velocity);
    if (t->slopes) ancf_value_of(p->bending, p->dof, p->T, m, velocity);
    for (int c = 0; c < 3; c++) p->impulse[c] = p->couple[c] = p->moment[c] = p->acceleration[c] = p->bends[c] = 0.0;
}

static void start_body(ancf_body* b) {
    for (int c = 0; c < 3; c++) {
        b->before[c] = b->velocity[c];
        b->before[3 + c] = b->spin[c];
        b->taken[c] = b->impulse[c];
        b->taken[3 + c] = b->twist[c];
        b->acceleration[c] = b->given[c];
        b->turning[c] = b->given[3 + c];
        b->shift[c] = b->turn[c] = 0.0;
    }
}

static double body_compliance(const ancf_body* b, const double arm[3], const double direction[3]) {
    double twist[3], answer[6];
    ancf_cross(twist, arm, direction);
    ancf_body_answer(answer, b, direction, twist);
    return ancf_dot(answer, direction) + ancf_dot(answer + 3, twist);
}

// Velocity along the normal by a unit impulse along it [1/kg].
static double compliance(const ancf_table* t, const ancf_contact* c) {
    double w = 0.0;
    for (int s = 0; s < 2; ++s) {
        if (c->side[s].place >= 0) w += t->place[c->side[s].place].compliance;
        if (c->side[s].body >= 0) w += body_compliance(&t->body[c->side[s].body], c->side[s].arm, c->normal);
    }
    if (c->side[0].place >= 0 && c->side[1].place >= 0)
        w -= 2.0 * ancf_table_effects(t, c->side[0].place, c->side[1].place).effect;
    return w > 0.0 ? w : 0.0;
}

static void start_contact(ancf_table* t, ancf_contact* c) {
    c->own = compliance(t, c);
    c->impulse = c->force = c->energy = 0.0;
    memcpy(c->start, c->side[1].arm, sizeof c->start);
    memcpy(c->line, c->normal, sizeof c->line);
    for (int k = 0; k < 3; k++) c->guess[k] = c->late[k] = c->balanced[k] = 0.0;
    if (ancf_lever_has(c)) ancf_lever_prepare(t, c);
}

// Places on the nodes that slide: what moves a cable near them, they feel.
static ancf_error add_slides(ancf_table* t, const ancf_model* m) {
    const int first = t->n_places;
    if (m->n_slides == 0 || t->n_contacts + t->n_couplings == 0) return ANCF_OK;
    if (!ancf_reserve((void**)&t->hold, &t->room_hold, 2 * m->n_slides, sizeof *t->hold)) return ANCF_E_MEMORY;
    for (int i = 0; i < m->n_slides && t->slides < 0; ++i)
        if (ancf_table_add_knot(t, m, m->slide[i].node) < 0) return ANCF_E_MEMORY;
    if (t->slides < 0) t->slides = first;
    for (int i = 0; i < m->n_slides; ++i) t->place[t->slides + i].idle = false;
    return ANCF_OK;
}

ancf_error ancf_table_start(ancf_table* t, const ancf_model* m, const double* velocity) {
    if (add_slides(t, m)) return ANCF_E_MEMORY;
    if (!make_room(t) || !make_sums(t)) return ANCF_E_MEMORY;
    t->model = m;
    t->guessed = false;
    for (int i = 0; i < t->n_places; ++i) {
        ancf_place* p = &t->place[i];
        p->compliance = 0.0;
        if (p->idle) memset(p->impulse, 0, sizeof p->impulse);
        else start_place(t, p, m, velocity);
    }
    list_uses(t);
    const ancf_error error = make_effects(t);
    forget_uses(t);
    if (error) return error;
    if (t->factored && !m->mass->diagonal && m->mass->n > 0) {
        const ancf_error missing = ancf_knots_factor_make(&t->knots, m);
        if (missing) return missing;
    }
    if (!ancf_groups_make(&t->groups, t)) return ANCF_E_MEMORY;
    t->most = -1;
    for (int i = 0; i < t->n_bodies; ++i) start_body(&t->body[i]);
    for (int i = 0; i < t->n_contacts; ++i) {
        ancf_contact* c = &t->contact[i];
        if (c->idle) c->impulse = c->energy = c->late[0] = c->late[1] = c->late[2] = 0.0;
        else start_contact(t, c);
    }
    return ANCF_OK;
}

ancf_error ancf_table_prepare(ancf_table* t, const ancf_model* m, const double* velocity) {
    for (int i = 0; i < t->n_contacts; ++i) {
        ancf_contact* c = &t->contact[i];
        c->before = c->repaid = c->damped = c->rubbed = c->found = c->left = 0.0;
        c->depth = c->gap < 0.0 ? -c->gap : 0.0;
        for (int k = 0; k < 3; k++) c->pressed[k] = c->dragged[k] = c->changing[k] = 0.0;
    }
    t->left[0] = t->left[1] = t->left[2] = 0.0;
    return ancf_table_start(t, m, velocity);
}

// Difference of the places' accelerations; of bodies they change less.
static void changing_of(double a[3], const ancf_table* t, const ancf_contact* c) {
    for (int k = 0; k < 3; k++) {
        a[k] = 0.0;
        for (int s = 0; s < 2; ++s)
            if (c->side[s].place >= 0) a[k] += (s ? -1.0 : 1.0) * t->place[c->side[s].place].acceleration[k];
    }
}

void ancf_table_accelerate(ancf_table* t, const ancf_model* m, const double* acceleration) {
    for (int i = 0; i < t->n_places; ++i) {
        ancf_place* p = &t->place[i];
        if (p->idle) continue;
        ancf_value_of(p->acceleration, p->dof, p->S, m, acceleration);
        if (t->slopes) ancf_value_of(p->bends, p->dof, p->T, m, acceleration);
    }
    for (int i = 0; i < t->n_contacts; ++i)
        if (!t->contact[i].idle) changing_of(t->contact[i].changing, t, &t->contact[i]);
}

static void speed_up_place(ancf_place* p, double time) {
    for (int c = 0; c < 3; c++) {
        p->velocity[c] += time * p->acceleration[c];
        p->bending[c] += time * p->bends[c];
    }
}

static void speed_up_body(ancf_body* b, double time) {
    for (int c = 0; c < 3; c++) {
        b->velocity[c] += time * b->acceleration[c];
        b->spin[c] += time * b->turning[c];
    }
}

void ancf_table_speed_up(ancf_table* t, double time) {
    for (int i = 0; i < t->n_places; ++i) speed_up_place(&t->place[i], time);
    for (int i = 0; i < t->n_bodies; ++i) speed_up_body(&t->body[i], time);
}

void ancf_table_speed_up_group(ancf_table* t, const ancf_contact_group* group, double time) {
    const int *places = t->groups.list[ANCF_PLACES], *bodies = t->groups.list[ANCF_BODIES];
    for (int i = group->first[ANCF_PLACES]; i < group->end[ANCF_PLACES]; ++i)
        speed_up_place(&t->place[places[i]], time);
    for (int i = group->first[ANCF_BODIES]; i < group->end[ANCF_BODIES]; ++i) speed_up_body(&t->body[bodies[i]], time);
}

bool ancf_table_hold(const ancf_table* t, int place, const double impulse[3], const double couple[3]) {
    const int n = t->slides < 0 ? 0 : t->model->n_slides;
    double(*gained)[3] = t->hold + n;
    bool any = false;
    if (n == 0) return false;
    memset(gained, 0, (size_t)n * sizeof *gained);
    for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
        const int slide = t->other[k] - t->slides;
        if (slide < 0 || slide >= n) continue;
        any = true;
        for (int c = 0; c < 3; c++)
            gained[slide][c] += t->effect[k] * impulse[c] + (couple ? t->bend[k].from * couple[c] : 0.0);
    }
    if (any) ancf_slides_hold(t->hold, t->model, gained);
    return any;
}

static void kick_freely(ancf_table* t, int place, const double impulse[3], double rest) {
    ancf_place* p = &t->place[place];
    for (int c = 0; c < 3; c++) {
        p->impulse[c] += impulse[c];
        p->moment[c] += rest * impulse[c];
    }
    for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
        double* v = t->place[t->other[k]].velocity;
        for (int c = 0; c < 3; c++) v[c] += t->effect[k] * impulse[c];
    }
    if (!t->slopes) return;
    for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
        double* u = t->place[t->other[k]].bending;
        for (int c = 0; c < 3; c++) u[c] += t->bend[k].to * impulse[c];
    }
}

// Gives the nodes that slide what was found to hold them.
static void kick_slides(ancf_table* t, double rest) {
    for (int i = 0; i < t->model->n_slides; ++i)
        if (t->hold[i][0] != 0.0 || t->hold[i][1] != 0.0 || t->hold[i][2] != 0.0)
            kick_freely(t, t->slides + i, t->hold[i], rest);
}

void ancf_table_kick_place(ancf_table* t, int place, const double impulse[3], double rest) {
    kick_freely(t, place, impulse, rest);
    if (ancf_table_hold(t, place, impulse, NULL)) kick_slides(t, rest);
}

void ancf_table_kick_slope(ancf_table* t, int place, const double impulse[3], double step) {
    for (int c = 0; c < 3; c++) t->place[place].couple[c] += impulse[c];
    for (int k = t->first[place]; k < t->first[place + 1]; ++k) {
        ancf_place* p = &t->place[t->other[k]];
        for (int c = 0; c < 3; c++) {
            p->velocity[c] += t->bend[k].from * impulse[c];
            p->bending[c] += t->bend[k].both * impulse[c];
        }
    }
    if (ancf_table_hold(t, place, (double[3]) {0.0, 0.0, 0.0}, impulse)) kick_slides(t, step);
}

void ancf_table_kick_body(ancf_table* t, int body, const double arm[3], const double impulse[3], double rest) {
    ancf_body* b = &t->body[body];
    double twist[3], answer[6];
    ancf_cross(twist, arm, impulse);
    ancf_body_answer(answer, b, impulse, twist);
    for (int c = 0; c < 3; c++) {
        b->velocity[c] += answer[c];
        b->spin[c] += answer[3 + c];
        b->shift[c] += rest * answer[c];
        b->turn[c] += rest * answer[3 + c];
        b->impulse[c] += impulse[c];
        b->twist[c] += twist[c];
    }
}

void ancf_table_kick(ancf_table* t, const ancf_contact* c, const double impulse[3], double rest) {
    const double back[3] = {-impulse[0], -impulse[1], -impulse[2]};
    for (int s = 0; s < 2; ++s) {
        const ancf_side* side = &c->side[s];
        const double* given = s ? back : impulse;
        if (side->place >= 0) ancf_table_kick_place(t, side->place, given, rest);
        if (side->body >= 0) ancf_table_kick_body(t, side->body, side->arm, given, rest);
    }
}

void ancf_table_slip(double v[3], const ancf_table* t, const ancf_contact* c) {
    for (int i = 0; i < 3; i++) v[i] = 0.0;
    for (int s = 0; s < 2; ++s) {
        const double sign = s ? -1.0 : 1.0;
        if (c->side[s].place >= 0)
            for (int i = 0; i < 3; i++) v[i] += sign * t->place[c->side[s].place].velocity[i];
        if (c->side[s].body >= 0) {
            double u[3];
            ancf_body_velocity(u, &t->body[c->side[s].body], c->side[s].arm);
            for (int i = 0; i < 3; i++) v[i] += sign * u[i];
        }
    }
}

static bool nonzero(const double* v, int n) {
    for (int i = 0; i < n; ++i)
        if (v[i] != 0.0) return true;
    return false;
}

void ancf_body_answer(double answer[6], const ancf_body* b, const double impulse[3], const double twist[3]) {
    const double guided = ancf_dot(b->along, impulse);
    for (int c = 0; c < 3; c++) answer[c] = b->inv_mass[c] * impulse[c] + guided * b->along[c];
    ancf_multiply(answer + 3, b->inv_inertia, twist);
}

bool ancf_body_moves(const ancf_body* b) {
    return nonzero(b->inv_mass, 3) || nonzero(b->inv_inertia, 9) || nonzero(b->along, 3) ||
           nonzero(b->acceleration, 3) || nonzero(b->turning, 3);
}

static const double still[3] = {0.0, 0.0, 0.0}; // a side that is neither a place nor a body

double ancf_table_opening(const ancf_table* t, const ancf_contact* c) {
    double v[3];
    ancf_table_slip(v, t, c);
    return ancf_dot(v, c->normal);
}

static const double* velocity_at(const ancf_table* t, const ancf_side* side) {
    if (side->place >= 0) return t->place[side->place].velocity;
    return side->body >= 0 ? t->body[side->body].velocity : still;
}

static const double* acceleration_at(const ancf_table* t, const ancf_side* side) {
    if (side->place >= 0) return t->place[side->place].acceleration;
    return side->body >= 0 ? t->body[side->body].acceleration : still;
}

void ancf_table_going(double v[3], const ancf_table* t, const ancf_contact* c) {
    const double *there = velocity_at(t, &c->side[0]), *here = velocity_at(t, &c->side[1]);
    for (int i = 0; i < 3; i++) v[i] = there[i] - here[i];
}

void ancf_table_changing(double a[3], const ancf_table* t, const ancf_contact* c) {
    const double *there = acceleration_at(t, &c->side[0]), *here = acceleration_at(t, &c->side[1]);
    for (int i = 0; i < 3; i++) a[i] = there[i] - here[i];
}

ancf_effects ancf_table_effects(const ancf_table* t, int from, int to) {
    for (int k = t->first[from]; k < t->first[from + 1]; ++k)
        if (t->other[k] == to) return (ancf_effects) {t->effect[k], t->bend[k]};
    return (ancf_effects) {0};
}

void ancf_table_end(ancf_table* t, double step) {
    for (int i = 0; i < t->n_bodies; ++i) {
        ancf_body* b = &t->body[i];
        for (int c = 0; c < 3; c++) {
            b->moved[c] += step * (b->before[c] - t->passed * b->given[c]) + b->shift[c];
            b->turned[c] += step * (b->before[3 + c] - t->passed * b->given[3 + c]) + b->turn[c];
            b->work += 0.5 * (b->impulse[c] - b->taken[c]) * (b->before[c] + b->velocity[c]);
            b->work += 0.5 * (b->twist[c] - b->taken[3 + c]) * (b->before[3 + c] + b->spin[c]);
        }
    }
    for (int i = 0; i < t->groups.contacts; ++i) {
        ancf_contact* c = &t->contact[t->groups.list[ANCF_CONTACTS][i]];
        c->owed -= 0.5 * ancf_dot(c->late, c->changing);
        for (int k = 0; k < 3; k++) {
            c->pressed[k] += c->impulse * c->normal[k];
            c->dragged[k] += step * c->friction[k];
        }
    }
}

// Friction came after the normal forces and acts from the start of the step: it has moved what they acted on by then.
static void twist_late(ancf_table* t, const ancf_contact* c) {
    double arm[3], twist[3], spin[3];
    if (c->impulse == 0.0 || c->side[1].body < 0) return;
    ancf_table_going(arm, t, c);
    for (int i = 0; i < 3; i++) arm[i] -= c->going[i];
    ancf_cross(twist, c->late, arm);
    ancf_body* b = &t->body[c->side[1].body];
    ancf_multiply(spin, b->inv_inertia, twist);
    for (int i = 0; i < 3; i++) {
        b->twist[i] += twist[i];
        b->spin[i] += spin[i];
    }
}

double ancf_owed(double before, const double late[3], const double changing[3]) {
    return before + 0.5 * ancf_dot(late, changing);
}

// What a place's impulses do, along its response.
static void spread(const ancf_place* p, const ancf_model* m, double step, double* velocity, double* shift) {
    const double *J = p->impulse, *K = p->moment, *C = p->couple;
    const bool bent = nonzero(C, 3);
    if (!bent && !nonzero(J, 3)) return;
    for (int k = 0; k < p->response->n; ++k) {
        const double dv = answer(p, p->S, k), du = bent ? answer(p, p->T, k) : 0.0;
        const int dof = p->response->dof[k];
        for (int c = 0; c < 3; c++) {
            velocity[c * m->stride + dof] += dv * J[c] + du * C[c];
            shift[c * m->stride + dof] += dv * (K[c] - step * J[c]);
        }
    }
}

static const double unmoved = 1e-15; // part of the way by a place's impulse over a whole step that is but rounding

// Whether impulses move anything besides `step` times the velocity that they give: those at the start of the step do
// not.
static bool any_late(const ancf_table* t, double step) {
    for (int i = 0; i < t->n_places; ++i) {
        const ancf_place* p = &t->place[i];
        for (int c = 0; c < 3 && !p->idle; c++) {
            const double whole = step * p->impulse[c];
            if (fabs(p->moment[c] - whole) > unmoved * fabs(whole)) return true;
        }
    }
    return false;
}

// What they all do, by one solve for the velocity and one for the shift, in the first two fields of m->work: what
// damping takes out of this step stands in those behind.
static void spread_all(const ancf_table* t, const ancf_model* m, double step, double* velocity, double* shift) {
    const size_t size = 3 * (size_t)m->stride;
    double *force = m->work, *answer = force + size;
    const int fields = any_late(t, step) ? 2 : 1;
    for (int late = 0; late < fields; ++late) {
        double* field = late ? shift : velocity;
        memset(force, 0, 2 * size * sizeof *force);
        for (int i = 0; i < t->n_places; ++i) {
            const ancf_place* p = &t->place[i];
            for (int c = 0; c < 3 && !p->idle; c++) {
                const double J = late ? p->moment[c] - step * p->impulse[c] : p->impulse[c],
                             C = late ? 0.0 : p->couple[c];
                for (int k = 0; k < 4; ++k) force[c * m->stride + p->dof[k]] += p->S[k] * J + p->T[k] * C;
            }
        }
        ancf_model_join(m, force);
        ancf_mass_solve(m, answer, force);
        for (size_t i = 0; i < size; ++i) field[i] += answer[i];
    }
}

void ancf_table_apply(ancf_table* t, const ancf_model* m, double step, double* velocity, double* shift) {
    long entries = 0; // of responses; a solve goes through a few times as many as there are unknowns
    ancf_lever_balance(t, step);
    for (int i = 0; i < t->groups.contacts; ++i) twist_late(t, &t->contact[t->groups.list[ANCF_CONTACTS][i]]);
    for (int i = 0; i < t->n_places; ++i)
        if (!t->place[i].idle) entries += t->place[i].response->n;
    if (entries > 8L * m->n_dof) {
        spread_all(t, m, step, velocity, shift);
        return;
    }
    for (int i = 0; i < t->n_places; ++i)
        if (!t->place[i].idle) spread(&t->place[i], m, step, velocity, shift);
}

void ancf_table_forces(const ancf_table* t, const ancf_model* m, double time, double* force) {
    for (int i = 0; i < t->n_places; ++i) {
        if (t->slides >= 0 && i >= t->slides && i < t->slides + m->n_slides) continue;
        const ancf_place* p = &t->place[i];
        for (int k = 0; k < 4; ++k) {
            const int dof = p->dof[k], twin = m->hold[dof] ? ancf_model_twin(m, dof) : -1;
            for (int c = 0; c < 3; c++) {
                const double more = (p->S[k] * p->impulse[c] + p->T[k] * p->couple[c]) / time;
                force[c * m->stride + dof] += more;
                if (twin >= 0) force[c * m->stride + twin] += more;
            }
        }
    }
}

void ancf_table_impulse(double impulse[3], const ancf_table* t, const ancf_model* m, int dof) {
    const int twin = ancf_model_twin(m, dof);
    for (int c = 0; c < 3; c++) impulse[c] = 0.0;
    for (int i = 0; i < t->n_places; ++i)
        for (int k = 0; k < 4; ++k) {
            const ancf_place* p = &t->place[i];
            if (p->idle || (p->dof[k] != dof && p->dof[k] != twin)) continue;
            for (int c = 0; c < 3; c++) impulse[c] += p->S[k] * p->impulse[c] + p->T[k] * p->couple[c];
        }
}

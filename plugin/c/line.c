#include "ancf/line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AT_ONCE = 8 }; // rounds in which all places that contradict their law change at once; then one a round

ancf_error ancf_line_create(ancf_line** line, int spans, double ea, double radius) {
    *line = NULL;
    if (spans < 1) return ANCF_E_EMPTY;
    const size_t n = (size_t)spans, block = 14 * n + 4;
    ancf_line* l = calloc(1, sizeof *l);
    double* numbers = calloc(block, sizeof *numbers);
    int* slides = calloc(n + 1, sizeof *slides);
    if (!l || !numbers || !slides) {
        free(l);
        free(numbers);
        free(slides);
        return ANCF_E_MEMORY;
    }
    const ancf_winch held = {0.0, 0.0, INFINITY, 0.0, INFINITY};
    *l = (ancf_line) {.spans = spans, .ea = ea, .radius = radius, .winch = {held, held}, .slides = slides};
    l->along = (double(*)[3])numbers; // first: what was allocated
    l->length = numbers + 3 * n;
    l->tension = l->length + n;
    l->way = l->tension + n;
    l->friction = l->way + n;
    l->flow = l->friction + n + 1;
    l->work = l->flow + n + 1;
    *line = l;
    return ANCF_OK;
}

void ancf_line_destroy(ancf_line* line) {
    if (!line) return;
    free(line->along);
    free(line->slides);
    free(line);
}

void ancf_line_lay(ancf_line* line, const double (*x)[3]) {
    for (int i = 0; i < line->spans; ++i) {
        double d[3], square = line->radius * line->radius;
        for (int c = 0; c < 3; ++c) {
            d[c] = x[i + 1][c] - x[i][c];
            square += d[c] * d[c];
        }
        const double way = sqrt(square);
        line->way[i] = way;
        for (int c = 0; c < 3; ++c) line->along[i][c] = way > 0.0 ? d[c] / way : 0.0;
    }
}

static double total(const double* values, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += values[i];
    return sum;
}

void ancf_line_pull(double force[3], const ancf_line* line, int place) {
    for (int c = 0; c < 3; ++c) {
        force[c] = 0.0;
        if (place < line->spans) force[c] += line->tension[place] * line->along[place][c];
        if (place > 0) force[c] -= line->tension[place - 1] * line->along[place - 1][c];
    }
}

double ancf_line_length(const ancf_line* line) { return total(line->length, line->spans); }

double ancf_line_energy(const ancf_line* line) {
    double sum = 0.0;
    for (int i = 0; i < line->spans; ++i) sum += 0.5 * line->tension[i] * line->tension[i] * line->length[i] / line->ea;
    return sum;
}

// ---------------------------------------------------------------- what flows in a step

typedef struct {
    ancf_line* line;
    double draw[2]; // what the winches' speeds ask for, onto the drum [m]
    double* was;    // (spans) unstressed lengths before the step [m]
    double* pull;   // (spans) pull_of() before it [N]
    double* fed;    // (spans) unstressed lengths with what comes in at the ends, before anything slides [m]
    double* factor; // (spans) of a tension: over that of the first of its strand
    double* hold;   // (spans + 1) of a ring: how many times one tension beside it the other is at most
    double* next;   // (spans + 1) what a place should do
} pass;

static double angle(const double p[3], const double q[3]) {
    const double cross[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
    return atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]),
                 p[0] * q[0] + p[1] * q[1] + p[2] * q[2]);
}

// Unstressed lengths of spans that slack is left in: it stays where it is, as far as there is any.
static void leave_slack(const pass* p, int begin, int end, double all) {
    const ancf_line* l = p->line;
    double spare = 0.0;
    for (int i = begin; i < end; ++i) spare += fmax(0.0, p->fed[i] - l->way[i]);
    const double left = all - total(l->way + begin, end - begin), share = spare > 0.0 ? left / spare : 0.0;
    for (int i = begin; i < end; ++i) {
        l->length[i] = l->way[i] + share * fmax(0.0, p->fed[i] - l->way[i]);
        l->tension[i] = 0.0;
    }
}

// Strain of a strand's first span when all of it is so long without stress.
static double strain_of(const pass* p, int begin, int end, double all) {
    const double* way = p->line->way;
    double strain = 0.0;
    for (int round = 0; round < 60; ++round) { // from below, as the function is convex and falls
        double sum = -all, slope = 0.0;
        for (int i = begin; i < end; ++i) {
            const double part = 1.0 / (1.0 + p->factor[i] * strain);
            sum += way[i] * part;
            slope += way[i] * part * part * p->factor[i];
        }
        const double more = sum / slope;
        strain += more;
        if (!(more > 1e-15 * (1.0 + strain))) break;
    }
    return fmax(0.0, strain);
}

// Force that an end keeps its span at, or a negative number: its flow is given.
static double force_at(const pass* p, int end) {
    const ancf_line* l = p->line;
    switch (l->slides[end ? l->spans : 0]) {
    case ANCF_STRAINS:
        return l->winch[end].force;
    case ANCF_SLIPS:
        return l->winch[end].brake;
    default:
        return -1.0;
    }
}

static double flow_at(const pass* p, int end) {
    const double out = p->line->slides[end ? p->line->spans : 0] == ANCF_DRAWS ? p->draw[end] : 0.0;
    return end ? out : -out;
}

// Lengths and tensions of the spans between two places that nothing slides through, or the ends.
static void settle(const pass* p, int begin, int end) {
    ancf_line* l = p->line;
    p->factor[begin] = 1.0;
    for (int i = begin + 1; i < end; ++i)
        p->factor[i] = p->factor[i - 1] * (l->slides[i] > 0 ? p->hold[i] : 1.0 / p->hold[i]);
    const bool first = begin == 0, last = end == l->spans;
    const double force[2] = {first ? force_at(p, 0) : -1.0, last ? force_at(p, 1) : -1.0};
    double strain;
    if (force[0] >= 0.0 || force[1] >= 0.0) {
        strain = force[0] >= 0.0 ? force[0] / l->ea : force[1] / l->ea / p->factor[end - 1];
    } else {
        memcpy(p->fed + begin, p->was + begin, (size_t)(end - begin) * sizeof *p->fed);
        if (first) p->fed[0] += flow_at(p, 0);
        if (last) p->fed[end - 1] -= flow_at(p, 1);
        const double all = total(p->fed + begin, end - begin);
        if (total(l->way + begin, end - begin) <= all) {
            leave_slack(p, begin, end, all);
            return;
        }
        strain = strain_of(p, begin, end, all);
    }
    for (int i = begin; i < end; ++i) {
        l->tension[i] = l->ea * p->factor[i] * strain;
        l->length[i] = l->way[i] / (1.0 + p->factor[i] * strain);
    }
}

// Of a strand, whose flow at one of its ends is known.
static void find_flow(const pass* p, int begin, int end) {
    ancf_line* l = p->line;
    if (begin == 0 && force_at(p, 0) >= 0.0) {
        l->flow[end] = end == l->spans ? flow_at(p, 1) : 0.0;
        for (int i = end; i > begin; --i) l->flow[i - 1] = l->flow[i] + (l->length[i - 1] - p->was[i - 1]);
        return;
    }
    l->flow[begin] = begin == 0 ? flow_at(p, 0) : 0.0;
    for (int i = begin; i < end; ++i) l->flow[i + 1] = l->flow[i] - (l->length[i] - p->was[i]);
    if (end == l->spans && force_at(p, 1) < 0.0) l->flow[end] = flow_at(p, 1); // without what was rounded
}

static void settle_all(const pass* p) {
    const ancf_line* l = p->line;
    for (int begin = 0, end; begin < l->spans; begin = end) {
        for (end = begin + 1; end < l->spans && l->slides[end]; ++end) {
        }
        settle(p, begin, end);
        find_flow(p, begin, end);
    }
}

// How a ring slides by what was found: as it does, or otherwise if that contradicts Eytelwein's equation.
static int ring_by_law(const pass* p, int ring) {
    const ancf_line* l = p->line;
    const double before = l->tension[ring - 1], behind = l->tension[ring], hold = p->hold[ring] * (1.0 + 1e-12);
    const int slides = l->slides[ring];
    if (slides) {
        if (hold < 1.0 + 2e-12 || before + behind == 0.0) return slides; // without friction, either way
        return slides * l->flow[ring] < 0.0 ? 0 : slides;
    }
    if (behind > before * hold) return 1;
    return before > behind * hold ? -1 : 0;
}

static int end_by_law(const pass* p, int end) {
    const ancf_line* l = p->line;
    const int place = end ? l->spans : 0;
    const ancf_winch* w = &l->winch[end];
    const double tension = l->tension[end ? l->spans - 1 : 0], above = 1.0 + 1e-12,
                 drawn = end ? l->flow[place] : -l->flow[place];
    switch (l->slides[place]) {
    case ANCF_STRAINS:
        return drawn < 0.0 ? ANCF_HOLDS : drawn > p->draw[end] ? ANCF_DRAWS : ANCF_STRAINS;
    case ANCF_SLIPS:
        if (drawn <= fmin(0.0, p->draw[end])) return ANCF_SLIPS;
        return p->draw[end] < 0.0 ? ANCF_DRAWS : ANCF_HOLDS;
    case ANCF_DRAWS:
        if (p->draw[end] > 0.0) return tension > w->force * above ? ANCF_STRAINS : ANCF_DRAWS;
        if (tension > w->brake * above) return ANCF_SLIPS;
        return p->draw[end] < 0.0 ? ANCF_DRAWS : ANCF_HOLDS;
    default:
        if (p->draw[end] < 0.0) return ANCF_DRAWS;
        if (tension > w->brake * above) return ANCF_SLIPS;
        return p->draw[end] > 0.0 && tension < w->force ? ANCF_DRAWS : ANCF_HOLDS;
    }
}

// Both ends cannot keep one strand at their forces: the one that would be overcome does something else.
static void part_ends(const pass* p) {
    ancf_line* l = p->line;
    int* slides = l->slides;
    const int n = l->spans;
    for (int i = 1; i < n; ++i)
        if (!slides[i]) return;
    if (force_at(p, 0) < 0.0 || force_at(p, 1) < 0.0) return;
    double across = 1.0;
    for (int i = 1; i < n; ++i) across *= slides[i] > 0 ? p->hold[i] : 1.0 / p->hold[i];
    const bool first_stronger = force_at(p, 0) * across > force_at(p, 1);
    const int stronger = first_stronger ? 0 : n, weaker = first_stronger ? n : 0;
    if (slides[stronger] == ANCF_SLIPS) slides[stronger] = ANCF_HOLDS; // its brake is not reached
    else
        slides[slides[weaker] == ANCF_SLIPS ? stronger : weaker] =
            slides[weaker] == ANCF_SLIPS ? ANCF_DRAWS : ANCF_HOLDS; // it draws what the other lets out, or overcomes it
}

// Every place as its law has it; true if that was so.
static bool obey(const pass* p, bool one) {
    ancf_line* l = p->line;
    bool changed = false;
    for (int i = 0; i <= l->spans && !(one && changed); ++i) {
        const int now = i == 0 ? end_by_law(p, 0) : i == l->spans ? end_by_law(p, 1) : ring_by_law(p, i);
        changed = changed || now != l->slides[i];
        p->next[i] = now;
        if (one) l->slides[i] = now;
    }
    if (!one)
        for (int i = 0; i <= l->spans; ++i) l->slides[i] = (int)p->next[i];
    if (changed) part_ends(p);
    return !changed;
}

// Minus the derivative of a span's energy by its unstressed length [N].
static double pull_of(const ancf_line* l, double tension) { return tension + 0.5 * tension * tension / l->ea; }

// Work of friction and winches, each flow with the mean of the tensions at both ends of the step.
static void book(const pass* p) {
    ancf_line* l = p->line;
    const int n = l->spans;
    double* mean = p->pull;
    for (int i = 0; i < n; ++i) mean[i] = 0.5 * (mean[i] + pull_of(l, l->tension[i]));
    for (int i = 1; i < n; ++i) l->rubbed += (mean[i] - mean[i - 1]) * l->flow[i];
    l->drawn += mean[n - 1] * l->flow[n] - mean[0] * l->flow[0];
}

// What a winch asks for in a step of length dt, of a line of that length [m].
static double asked(const ancf_winch* w, double length, double dt) {
    const double draw = w->speed * dt;
    return draw > 0.0 ? fmax(0.0, fmin(draw, length - w->least)) : fmin(0.0, fmax(draw, length - w->most));
}

static pass begin(ancf_line* l, double dt) {
    const int n = l->spans;
    const double length = ancf_line_length(l);
    double* work = l->work;
    pass p = {.line = l, .was = work, .pull = work + n, .fed = work + 2 * n, .factor = work + 3 * n};
    p.hold = work + 4 * n;
    p.next = p.hold + n + 1;
    for (int end = 0; end < 2; ++end) p.draw[end] = asked(&l->winch[end], length, dt);
    for (int i = 0; i < n; ++i) {
        p.was[i] = l->length[i];
        p.pull[i] = pull_of(l, l->tension[i]);
    }
    for (int i = 1; i < n; ++i)
        p.hold[i] = l->friction[i] > 0.0 ? exp(l->friction[i] * angle(l->along[i - 1], l->along[i])) : 1.0;
    return p;
}

void ancf_line_step(ancf_line* line, const double (*x)[3], double dt) {
    ancf_line_lay(line, x);
    const pass p = begin(line, dt);
    const int most = AT_ONCE + 4 * line->spans;
    for (int round = 0;; ++round) {
        settle_all(&p);
        if (obey(&p, round >= AT_ONCE)) break;
        if (round < most) continue;
        ++line->unsettled;
        break;
    }
    book(&p);
}

// ---------------------------------------------------------------- how fast it swings

static double stiffness(const ancf_line* l, int span, double share) {
    return (l->ea + 2.0 * l->tension[span]) / fmax(l->radius, share * l->way[span]);
}

// With nothing sliding, by Gershgorin's rows over the spans.
static double all_stuck(const ancf_line* l, const double* w, double share) {
    double most = 0.0;
    for (int i = 0; i < l->spans; ++i) {
        const double k = stiffness(l, i, share), root = sqrt(k);
        double sum = k * (w[i] + w[i + 1]);
        sum += root * sqrt(stiffness(l, i > 0 ? i - 1 : l->spans - 1, share)) * w[i];
        sum += root * sqrt(stiffness(l, i + 1 < l->spans ? i + 1 : 0, share)) * w[i + 1];
        most = fmax(most, sum);
    }
    return most;
}

// With all sliding freely: one spring along the whole way, and what its tension does across.
static double all_free(const ancf_line* l, const double* w, double share) {
    double along = 0.0, across = 0.0, length = 0.0;
    for (int i = 0; i <= l->spans; ++i) along += (i == 0 || i == l->spans ? 1.0 : 4.0) * w[i];
    for (int i = 0; i < l->spans; ++i) {
        const double way = fmax(l->radius, share * l->way[i]);
        length += way;
        across = fmax(across, 2.0 * l->tension[i] / way * (w[i] + w[i + 1]));
    }
    return (l->ea + l->tension[0]) / length * along + across;
}

double ancf_line_frequency2(const ancf_line* line, const double* inverse_mass, double share) {
    const double stuck = all_stuck(line, inverse_mass, share);
    for (int i = 1; i < line->spans; ++i)
        if (line->friction[i] > 0.0) return stuck;
    return fmin(stuck, all_free(line, inverse_mass, share));
}

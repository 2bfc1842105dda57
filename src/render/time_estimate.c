/* A linear model of the cost of a tile with six terms: the number of its pixels; the time of its rays; that time
 * multiplied by the resampling (the fraction of edges or the number of samples); the means of these two times over the
 * tile and its eight neighbours, because few rays give little information; and the resampling. Terms are scaled to a
 * mean of 1 over the picture. Coefficients come from least squares (a tile counts less if its expected cost is large,
 * because its deviation grows with the cost). They are regularised towards the initial values with the weight of RIDGE
 * tiles, so that the first few tiles have little influence. They are not negative: a term that would be negative is
 * omitted. A finished tile only changes sums, so the cost of an estimate does not depend on the number of tiles. */
#include "render/time_estimate.h"

#include "base/mem.h"

#include <math.h>
#include <stddef.h>

enum { PIXELS, TIME, RESAMPLING_TIME, TIME_PRIOR, RESAMPLING_TIME_PRIOR, RESAMPLING };
enum { RIDGE = 10 };

/* Of edges, and of numbers of samples. */
static const double believed[2][TIME_ESTIMATE_TERMS] = {
    {[PIXELS] = 0.1, [TIME] = 0.4, [RESAMPLING_TIME] = 0.1, [TIME_PRIOR] = 0.3, [RESAMPLING_TIME_PRIOR] = 0.1},
    {[PIXELS] = 0.1, [RESAMPLING_TIME] = 0.4, [RESAMPLING_TIME_PRIOR] = 0.5}};

static const double *beliefs(const struct time_estimate *time_estimate) {
    return believed[time_estimate->proportional];
}

bool time_estimate_create(struct time_estimate *time_estimate, uint32_t count, uint32_t across, int workers) {
    *time_estimate = (struct time_estimate){.count = count, .across = across, .workers = workers};
    time_estimate->terms = mem_alloc_zero(count, sizeof *time_estimate->terms);
    time_estimate->sums = mem_alloc_zero((size_t)workers, sizeof *time_estimate->sums);
    for (int i = 0; time_estimate->sums && i < workers; i++)
        atomic_store(&time_estimate->sums[i].tile, TIME_ESTIMATE_NO_TILE);
    return time_estimate->terms && time_estimate->sums;
}

void time_estimate_destroy(struct time_estimate *time_estimate) {
    mem_free(time_estimate->terms);
    mem_free(time_estimate->sums);
    *time_estimate = (struct time_estimate){0};
}

/* --- what the rays saw --- */

void time_estimate_probe(struct time_estimate *time_estimate, uint32_t tile, double pixels, double cost,
                         double resampling) {
    float *terms = time_estimate->terms[tile];
    terms[PIXELS] = (float)pixels;
    terms[TIME] = (float)cost;
    terms[RESAMPLING_TIME] = (float)(cost * resampling);
    terms[RESAMPLING] = (float)(pixels * resampling);
}

static void neighbouring_terms(struct time_estimate *time_estimate, uint32_t tile) {
    uint32_t x = tile % time_estimate->across, y = tile / time_estimate->across,
             rows = time_estimate->count / time_estimate->across;
    double time = 0, resampling_time = 0, tiles = 0;
    for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < rows; v++) {
        for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < time_estimate->across; u++) {
            const float *other = time_estimate->terms[v * time_estimate->across + u];
            time += (double)other[TIME];
            resampling_time += (double)other[RESAMPLING_TIME];
            tiles += other[PIXELS] > 0;
        }
    }
    time_estimate->terms[tile][TIME_PRIOR] = (float)(time / tiles);
    time_estimate->terms[tile][RESAMPLING_TIME_PRIOR] = (float)(resampling_time / tiles);
}

void time_estimate_begin_tiles(struct time_estimate *time_estimate, bool proportional) {
    double wanted = 0;
    time_estimate->proportional = proportional;
    for (uint32_t tile = 0; tile < time_estimate->count; tile++) {
        float *terms = time_estimate->terms[tile];
        if (!(terms[PIXELS] > 0))
            continue;
        neighbouring_terms(time_estimate, tile);
        wanted++;
        for (int i = 0; i < TIME_ESTIMATE_TERMS; i++)
            time_estimate->all[i] += (double)terms[i];
    }
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++) {
        double mean = time_estimate->all[i] / wanted;
        for (uint32_t tile = 0; tile < time_estimate->count && mean > 0; tile++)
            time_estimate->terms[tile][i] = (float)((double)time_estimate->terms[tile][i] / mean);
        time_estimate->all[i] = mean > 0 ? wanted : 0;
    }
}

/* --- what tiles took --- */

void time_estimate_begin(struct time_estimate *time_estimate, int worker, uint32_t tile, double share) {
    struct time_estimate_sums *sums = &time_estimate->sums[worker];
    sum_store(&sums->share, share);
    sum_store(&sums->part[0], 0);
    sum_store(&sums->part[1], 0);
    atomic_store_explicit(&sums->tile, tile, memory_order_relaxed);
}

void time_estimate_part(struct time_estimate *time_estimate, int worker, int pass, double part) {
    sum_store(&time_estimate->sums[worker].part[pass], part);
}

void time_estimate_done(struct time_estimate *time_estimate, int worker, double cost, double first_pass_cost) {
    struct time_estimate_sums *sums = &time_estimate->sums[worker];
    const float *of_tile = time_estimate->terms[atomic_load_explicit(&sums->tile, memory_order_relaxed)];
    double terms[TIME_ESTIMATE_TERMS], expected = 0, share = sum_load(&sums->share);
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++) {
        terms[i] = share * (double)of_tile[i];
        expected += terms[i] * beliefs(time_estimate)[i];
    }
    double weight = 1 / fmax(expected, 0.1);
    atomic_store_explicit(&sums->tile, TIME_ESTIMATE_NO_TILE, memory_order_relaxed);
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++) {
        for (int k = 0; k < TIME_ESTIMATE_TERMS; k++)
            sum_add(&sums->products[i][k], weight * terms[i] * terms[k]);
        sum_add(&sums->costs[i], weight * terms[i] * cost);
        sum_add(&sums->done[i], terms[i]);
    }
    sum_add(&sums->weight, expected);
    sum_add(&sums->cost, cost);
    sum_add(&sums->first_cost, first_pass_cost);
}

/* --- what the rest will take --- */

struct totals {
    double products[TIME_ESTIMATE_TERMS][TIME_ESTIMATE_TERMS], costs[TIME_ESTIMATE_TERMS], done[TIME_ESTIMATE_TERMS];
    double weight, cost, first_cost;
};

static struct totals add_up(const struct time_estimate *time_estimate) {
    struct totals all = {0};
    for (int w = 0; w < time_estimate->workers; w++) {
        const struct time_estimate_sums *sums = &time_estimate->sums[w];
        for (int i = 0; i < TIME_ESTIMATE_TERMS; i++) {
            for (int k = 0; k < TIME_ESTIMATE_TERMS; k++)
                all.products[i][k] += sum_load(&sums->products[i][k]);
            all.costs[i] += sum_load(&sums->costs[i]);
            all.done[i] += sum_load(&sums->done[i]);
        }
        all.weight += sum_load(&sums->weight);
        all.cost += sum_load(&sums->cost);
        all.first_cost += sum_load(&sums->first_cost);
    }
    return all;
}

/* Cholesky decomposition of the rows and columns with active terms; the ridge keeps it positive. */
static void solve(double matrix[TIME_ESTIMATE_TERMS][TIME_ESTIMATE_TERMS], const double right[TIME_ESTIMATE_TERMS],
                  const bool takes_part[TIME_ESTIMATE_TERMS], double out[TIME_ESTIMATE_TERMS]) {
    double lower[TIME_ESTIMATE_TERMS][TIME_ESTIMATE_TERMS] = {{0}};
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++) {
        out[i] = 0;
        for (int k = 0; k <= i && takes_part[i]; k++) {
            double sum = matrix[i][k];
            if (!takes_part[k])
                continue;
            for (int j = 0; j < k; j++)
                sum -= lower[i][j] * lower[k][j];
            lower[i][k] = i == k ? sqrt(sum) : sum / lower[k][k];
        }
        double sum = right[i];
        for (int j = 0; j < i; j++)
            sum -= lower[i][j] * out[j];
        out[i] = takes_part[i] ? sum / lower[i][i] : 0;
    }
    for (int i = TIME_ESTIMATE_TERMS - 1; i >= 0; i--) {
        double sum = out[i];
        for (int j = i + 1; j < TIME_ESTIMATE_TERMS; j++)
            sum -= lower[j][i] * out[j];
        out[i] = takes_part[i] ? sum / lower[i][i] : 0;
    }
}

static void fit(const double *believes, const struct totals *totals, double out[TIME_ESTIMATE_TERMS]) {
    double matrix[TIME_ESTIMATE_TERMS][TIME_ESTIMATE_TERMS], right[TIME_ESTIMATE_TERMS];
    bool takes_part[TIME_ESTIMATE_TERMS];
    double scale = totals->weight > 0 ? totals->cost / totals->weight : 1;
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++) {
        takes_part[i] = true;
        for (int k = 0; k < TIME_ESTIMATE_TERMS; k++)
            matrix[i][k] = totals->products[i][k] + (i == k ? RIDGE : 0);
        right[i] = totals->costs[i] + RIDGE * scale * believes[i];
    }
    for (int left = TIME_ESTIMATE_TERMS; left > 0; left--) {
        int lowest = 0;
        solve(matrix, right, takes_part, out);
        for (int i = 1; i < TIME_ESTIMATE_TERMS; i++)
            lowest = out[i] < out[lowest] ? i : lowest;
        if (out[lowest] >= 0)
            return;
        takes_part[lowest] = false;
    }
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++)
        out[i] = scale * believes[i];
}

static double combined(const double terms[TIME_ESTIMATE_TERMS], const double factors[TIME_ESTIMATE_TERMS]) {
    double sum = 0;
    for (int i = 0; i < TIME_ESTIMATE_TERMS; i++)
        sum += terms[i] * factors[i];
    return sum;
}

/* Tiles in progress, by the fraction of the cost so far that first passes had. */
static void add_parts(const struct time_estimate *time_estimate, const struct totals *totals,
                      double done[TIME_ESTIMATE_TERMS]) {
    double first = totals->cost > 0 ? totals->first_cost / totals->cost : 0.5;
    for (int w = 0; w < time_estimate->workers; w++) {
        const struct time_estimate_sums *sums = &time_estimate->sums[w];
        uint32_t tile = atomic_load_explicit(&sums->tile, memory_order_relaxed);
        double part =
            sum_load(&sums->share) * (first * sum_load(&sums->part[0]) + (1 - first) * sum_load(&sums->part[1]));
        for (int i = 0; tile < time_estimate->count && i < TIME_ESTIMATE_TERMS; i++)
            done[i] += part * (double)time_estimate->terms[tile][i];
    }
}

static void add_finished(const struct time_estimate *time_estimate, const struct film *film,
                         double done[TIME_ESTIMATE_TERMS]) {
    for (uint32_t tile = 0; tile < time_estimate->count; tile++) {
        bool finished = atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) == FILM_TILE_DONE;
        for (int i = 0; finished && i < TIME_ESTIMATE_TERMS; i++)
            done[i] += (double)time_estimate->terms[tile][i];
    }
}

struct time_estimate_work time_estimate_work(const struct time_estimate *time_estimate, const struct film *film) {
    struct totals totals = add_up(time_estimate);
    double factors[TIME_ESTIMATE_TERMS], done[TIME_ESTIMATE_TERMS] = {0};
    fit(beliefs(time_estimate), &totals, factors);
    if (film)
        add_finished(time_estimate, film, done);
    for (int i = 0; i < TIME_ESTIMATE_TERMS && !film; i++)
        done[i] = totals.done[i];
    add_parts(time_estimate, &totals, done);
    double all = combined(time_estimate->all, factors), made = fmin(combined(done, factors), all);
    return (struct time_estimate_work){made, all - made};
}

/* The estimate is the moment of the end and not the time left: between two forecasts the latter falls as the clock
 * goes. See time_estimate.h. */

void progress_estimate_reset(struct progress_estimate *progress_estimate, bool wanted) {
    atomic_store(&progress_estimate->share, 0);
    atomic_store(&progress_estimate->ends, 0);
    atomic_store(&progress_estimate->pace, 0);
    atomic_store(&progress_estimate->begun, wanted ? PROGRESS_ESTIMATE_WANTED : 0);
}

bool progress_estimate_is_wanted(const struct progress_estimate *progress_estimate) {
    return atomic_load(&progress_estimate->begun) != 0;
}

void progress_estimate_report(struct progress_estimate *progress_estimate, double done, double left, uint64_t now) {
    uint64_t begun = atomic_load_explicit(&progress_estimate->begun, memory_order_relaxed);
    uint64_t before = atomic_load_explicit(&progress_estimate->share, memory_order_relaxed);
    uint64_t share = 1 + (uint64_t)(1e9 * (done > 0 ? done / (done + left) : 0));
    if (share > before)
        atomic_store_explicit(&progress_estimate->share, share, memory_order_relaxed);
    if (done > 0 && now > begun)
        atomic_store_explicit(&progress_estimate->ends, now + (uint64_t)((double)(now - begun) * (left / done)),
                              memory_order_relaxed);
}

double progress_estimate_pace(const struct progress_estimate *progress_estimate) {
    uint64_t pace = atomic_load_explicit(&progress_estimate->pace, memory_order_relaxed);
    return pace > 0 && pace < 1000000 ? 1e-3 * (double)pace : 1;
}

double progress_estimate_share(const struct progress_estimate *progress_estimate) {
    uint64_t share = atomic_load_explicit(&progress_estimate->share, memory_order_relaxed);
    if (share == 0)
        return -1;
    return share < 1000000001 ? 1e-9 * (double)(share - 1) : 1;
}

double progress_estimate_left(const struct progress_estimate *progress_estimate, double now) {
    uint64_t ends = atomic_load_explicit(&progress_estimate->ends, memory_order_relaxed);
    if (ends == 0)
        return -1;
    double left = 1e-9 * (double)ends - now;
    return left > 0 ? left : 0;
}

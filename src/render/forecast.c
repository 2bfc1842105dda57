/* A linear model of a tile's cost with six terms: its pixels; the time of its rays; that time by the share of edges,
 * which is what will be sampled again; the mean of the last two over the tile and its eight neighbours, since few rays
 * tell little; edges alone. Terms are scaled to a mean of 1 over the picture. Coefficients are those of least squares
 * (a tile counts less the more it is expected to cost, as its deviation grows with it), drawn towards what is believed
 * before by the weight of RIDGE tiles, so that the first few tiles do not decide, and not negative: a term that would
 * be is left out. A tile that is done changes sums only, so a forecast costs the same however many tiles there are. */
#include "render/forecast.h"

#include "base/mem.h"

#include <math.h>

enum { PIXELS, TIME, EDGE_TIME, TIME_AROUND, EDGE_TIME_AROUND, EDGES };
enum { RIDGE = 10 };

static const double believed[FORECAST_TERMS] = {
    [PIXELS] = 0.1, [TIME] = 0.4, [EDGE_TIME] = 0.1, [TIME_AROUND] = 0.3, [EDGE_TIME_AROUND] = 0.1};

static double get(const _Atomic double *value) {
    return atomic_load_explicit(value, memory_order_relaxed);
}

/* Only one thread writes it. */
static void set(_Atomic double *value, double to) {
    atomic_store_explicit(value, to, memory_order_relaxed);
}

static void add(_Atomic double *value, double more) {
    set(value, get(value) + more);
}

bool forecast_create(struct forecast *forecast, uint32_t count, uint32_t across, int workers) {
    *forecast = (struct forecast){.count = count, .across = across, .workers = workers};
    forecast->terms = mem_alloc_zero(count, sizeof *forecast->terms);
    forecast->sums = mem_alloc_zero((size_t)workers, sizeof *forecast->sums);
    for (int i = 0; forecast->sums && i < workers; i++)
        atomic_store(&forecast->sums[i].tile, FORECAST_NO_TILE);
    return forecast->terms && forecast->sums;
}

void forecast_destroy(struct forecast *forecast) {
    mem_free(forecast->terms);
    mem_free(forecast->sums);
    *forecast = (struct forecast){0};
}

/* --- what the rays saw --- */

void forecast_look(struct forecast *forecast, uint32_t tile, double pixels, double cost, double edges) {
    float *terms = forecast->terms[tile];
    terms[PIXELS] = (float)pixels;
    terms[TIME] = (float)cost;
    terms[EDGE_TIME] = (float)(cost * edges);
    terms[EDGES] = (float)(pixels * edges);
}

static void look_around(struct forecast *forecast, uint32_t tile) {
    uint32_t x = tile % forecast->across, y = tile / forecast->across, rows = forecast->count / forecast->across;
    double time = 0, edge_time = 0, tiles = 0;
    for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < rows; v++) {
        for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < forecast->across; u++) {
            const float *other = forecast->terms[v * forecast->across + u];
            time += (double)other[TIME];
            edge_time += (double)other[EDGE_TIME];
            tiles += other[PIXELS] > 0;
        }
    }
    forecast->terms[tile][TIME_AROUND] = (float)(time / tiles);
    forecast->terms[tile][EDGE_TIME_AROUND] = (float)(edge_time / tiles);
}

void forecast_settle(struct forecast *forecast) {
    double wanted = 0;
    for (uint32_t tile = 0; tile < forecast->count; tile++) {
        float *terms = forecast->terms[tile];
        if (!(terms[PIXELS] > 0))
            continue;
        look_around(forecast, tile);
        wanted++;
        for (int i = 0; i < FORECAST_TERMS; i++)
            forecast->all[i] += (double)terms[i];
    }
    for (int i = 0; i < FORECAST_TERMS; i++) {
        double mean = forecast->all[i] / wanted;
        for (uint32_t tile = 0; tile < forecast->count && mean > 0; tile++)
            forecast->terms[tile][i] = (float)((double)forecast->terms[tile][i] / mean);
        forecast->all[i] = mean > 0 ? wanted : 0;
    }
}

/* --- what tiles took --- */

void forecast_begin(struct forecast *forecast, int worker, uint32_t tile, double share) {
    struct forecast_sums *sums = &forecast->sums[worker];
    set(&sums->share, share);
    set(&sums->part[0], 0);
    set(&sums->part[1], 0);
    atomic_store_explicit(&sums->tile, tile, memory_order_relaxed);
}

void forecast_part(struct forecast *forecast, int worker, int pass, double part) {
    set(&forecast->sums[worker].part[pass], part);
}

void forecast_done(struct forecast *forecast, int worker, double cost, double first_pass_cost) {
    struct forecast_sums *sums = &forecast->sums[worker];
    const float *of_tile = forecast->terms[atomic_load_explicit(&sums->tile, memory_order_relaxed)];
    double terms[FORECAST_TERMS], expected = 0, share = get(&sums->share);
    for (int i = 0; i < FORECAST_TERMS; i++) {
        terms[i] = share * (double)of_tile[i];
        expected += terms[i] * believed[i];
    }
    double weight = 1 / fmax(expected, 0.1);
    atomic_store_explicit(&sums->tile, FORECAST_NO_TILE, memory_order_relaxed);
    for (int i = 0; i < FORECAST_TERMS; i++) {
        for (int k = 0; k < FORECAST_TERMS; k++)
            add(&sums->products[i][k], weight * terms[i] * terms[k]);
        add(&sums->costs[i], weight * terms[i] * cost);
        add(&sums->done[i], terms[i]);
    }
    add(&sums->weight, expected);
    add(&sums->cost, cost);
    add(&sums->first_cost, first_pass_cost);
}

/* --- what the rest will take --- */

struct totals {
    double products[FORECAST_TERMS][FORECAST_TERMS], costs[FORECAST_TERMS], done[FORECAST_TERMS];
    double weight, cost, first_cost;
};

static struct totals add_up(const struct forecast *forecast) {
    struct totals all = {0};
    for (int w = 0; w < forecast->workers; w++) {
        const struct forecast_sums *sums = &forecast->sums[w];
        for (int i = 0; i < FORECAST_TERMS; i++) {
            for (int k = 0; k < FORECAST_TERMS; k++)
                all.products[i][k] += get(&sums->products[i][k]);
            all.costs[i] += get(&sums->costs[i]);
            all.done[i] += get(&sums->done[i]);
        }
        all.weight += get(&sums->weight);
        all.cost += get(&sums->cost);
        all.first_cost += get(&sums->first_cost);
    }
    return all;
}

/* Cholesky's decomposition of the rows and columns that take part; the ridge keeps it positive. */
static void solve(double matrix[FORECAST_TERMS][FORECAST_TERMS], const double right[FORECAST_TERMS],
                  const bool takes_part[FORECAST_TERMS], double out[FORECAST_TERMS]) {
    double lower[FORECAST_TERMS][FORECAST_TERMS] = {{0}};
    for (int i = 0; i < FORECAST_TERMS; i++) {
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
    for (int i = FORECAST_TERMS - 1; i >= 0; i--) {
        double sum = out[i];
        for (int j = i + 1; j < FORECAST_TERMS; j++)
            sum -= lower[j][i] * out[j];
        out[i] = takes_part[i] ? sum / lower[i][i] : 0;
    }
}

static void fit(const struct totals *totals, double out[FORECAST_TERMS]) {
    double matrix[FORECAST_TERMS][FORECAST_TERMS], right[FORECAST_TERMS];
    bool takes_part[FORECAST_TERMS];
    double scale = totals->weight > 0 ? totals->cost / totals->weight : 1;
    for (int i = 0; i < FORECAST_TERMS; i++) {
        takes_part[i] = true;
        for (int k = 0; k < FORECAST_TERMS; k++)
            matrix[i][k] = totals->products[i][k] + (i == k ? RIDGE : 0);
        right[i] = totals->costs[i] + RIDGE * scale * believed[i];
    }
    for (int left = FORECAST_TERMS; left > 0; left--) {
        int lowest = 0;
        solve(matrix, right, takes_part, out);
        for (int i = 1; i < FORECAST_TERMS; i++)
            lowest = out[i] < out[lowest] ? i : lowest;
        if (out[lowest] >= 0)
            return;
        takes_part[lowest] = false;
    }
    for (int i = 0; i < FORECAST_TERMS; i++)
        out[i] = scale * believed[i];
}

static double combined(const double terms[FORECAST_TERMS], const double factors[FORECAST_TERMS]) {
    double sum = 0;
    for (int i = 0; i < FORECAST_TERMS; i++)
        sum += terms[i] * factors[i];
    return sum;
}

/* Tiles under way, by the share that first passes had of the cost so far. */
static void add_parts(const struct forecast *forecast, const struct totals *totals, double done[FORECAST_TERMS]) {
    double first = totals->cost > 0 ? totals->first_cost / totals->cost : 0.5;
    for (int w = 0; w < forecast->workers; w++) {
        const struct forecast_sums *sums = &forecast->sums[w];
        uint32_t tile = atomic_load_explicit(&sums->tile, memory_order_relaxed);
        double part = get(&sums->share) * (first * get(&sums->part[0]) + (1 - first) * get(&sums->part[1]));
        for (int i = 0; tile < forecast->count && i < FORECAST_TERMS; i++)
            done[i] += part * (double)forecast->terms[tile][i];
    }
}

static void add_finished(const struct forecast *forecast, const struct film *film, double done[FORECAST_TERMS]) {
    for (uint32_t tile = 0; tile < forecast->count; tile++) {
        bool finished = atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) == FILM_TILE_DONE;
        for (int i = 0; finished && i < FORECAST_TERMS; i++)
            done[i] += (double)forecast->terms[tile][i];
    }
}

struct forecast_work forecast_work(const struct forecast *forecast, const struct film *film) {
    struct totals totals = add_up(forecast);
    double factors[FORECAST_TERMS], done[FORECAST_TERMS] = {0};
    fit(&totals, factors);
    if (film)
        add_finished(forecast, film, done);
    for (int i = 0; i < FORECAST_TERMS && !film; i++)
        done[i] = totals.done[i];
    add_parts(forecast, &totals, done);
    double all = combined(forecast->all, factors), made = fmin(combined(done, factors), all);
    return (struct forecast_work){made, all - made};
}

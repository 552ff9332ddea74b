/* SPDX-License-Identifier: GPL-3.0-or-later */
/* drive NAME...: subjects, by every function that its descriptor has, against CVODE on NAME_rhs, the closed form, and
 * the spec's second writing. Each runs in a process of its own, forked from this one, which has started once. NAME.ran
 * gets what differs, both values, and NAME.ended then is 1; else a line of the largest differences. NAME.err is what
 * sanitizers say.
 *
 * Bounds, over the largest value of any state in the run (of an output: of any output, or state):
 * states against CVODE, rtol 1e-10 or 1e-13: exact 1e-6; a smooth remainder 1e-4, 3e-3 and 5e-2 in order 4,
 *                                        2 and 1; with kinks 1e-2, in order 1 5e-2, and as much more as neighbours
 *                                        spread
 *     further from CVODE a smooth model of a fixed order may be up to 100 bounds, or as far as its status tells,
 *                                        if by eighths of a step it is nearer by 8 to the order, or by 1000 bounds
 *     the closed form                    1e-12 per step; of an output named inner... over its own largest value, or 1
 *     rhs, outputs against the second writing    1e-10, of the largest slope or output
 *     jump, set, retune                  1e-12 per step; at(h): 1e-12; at(0): get, to the last bit
 *     another scheme                     1e-6, and what the model's own steps make: as it differs from its eighths
 *     retune, by steps to a tolerance    twice the tolerance more, per step
 *     derivatives                        1e-5 of the largest of their column, by differences; 1e-9 backwards
 *     run                                2 units in the last place per step, and what outputs make of those of states;
 *                                        restore: to the last bit
 *     a batch                            1e-12 per step of one that steps alone
 * selftest 100 units in the last place; 1000 at velocities that damping wears down slowly from 100,
 *                                        where all steps round alike, and where breakpoints are passed, each of
 *                                        which spreads what rounding has made of the state; so much more as
 *                                        differences 10*x - y are larger than the states that they are made of;
 *                                        20 more per what loads sustain over the states, of 0.5 or more, that are
 *                                        kept less that
 * In float 2e-5 per step for what is 1e-12 in double, and at least 2e-3 beside CVODE. */
#include "driving.h"
#include "truth.h"
#include "../emitted/worse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static double worst_solution;

static void judge_truth(void)
{
	struct beside b = begin();
	if (of->slopes)
		judge_steps(b.model, 0, STEPS, h, row, "steps against CVODE");
	else
		judge_beside(&b, 0, STEPS, "steps against another scheme");
	end_beside(&b);
}

/* What outputs lose with modes that are dropped is said of the start and of loads, not of inputs, beside which nothing
 * bounds them: once more where inputs stay 0, and that has to hold. */
static void judge_losses(void)
{
	bool unbounded = false;
	for (int i = 0; i < outputs; i++)
		unbounded = unbounded || isinf(loss_of(output_name(i)));
	if (!unbounded)
		return;
	undriven = true;
	run_steps();
	judge_truth();
	undriven = false;
	run_steps();
}

static void judge_solution(void)
{
	FILE *const file = of->solution ? fopen(of->solution, "r") : NULL;
	char line[1 << 14];
	if (!file)
		return;
	if (!fgets(line, sizeof line, file))
		complain("the solution has no first line");
	for (int k = 0; k <= STEPS; k++) {
		char *p = line;
		if (!fgets(line, sizeof line, file)) {
			complain("the solution has %d rows, expected %d", k, STEPS + 1);
			break;
		}
		const double t = strtod(p, &p);
		bool good = near(row[k].t, t, in_float ? 1e-6 : 1e-13, "time", t, "t");
		for (int i = 0; i < outputs; i++) {
			const double expected = strtod(p + 1, &p);
			good = near(row[k].out[i], expected, rounding(k) * own[i] + loss_of(output_name(i)),
				"output against the closed form", t,
				output_name(i)) && good;
			worst_solution = worse(worst_solution, fabs(row[k].out[i] - expected) / own[i]);
		}
		if (!good)
			break;
	}
	fclose(file);
}

static bool same_bits(const double *a, const double *b, int n)
{
	for (int i = 0; i < n; i++)
		if (!(a[i] == b[i]))
			return false;
	return true;
}

/* What one unit in the state may make in each output: a difference of large positions, many */
static void find_gains(double *gain)
{
	void *const s = fresh();
	double y[MOST], still[MOST], moved[MOST];
	memcpy(y, row[STEPS].y, sizeof y);
	memset(gain, 0, sizeof *gain * MOST);
	for (int j = -1; j < states; j++) {
		const double from = j < 0 ? 0 : y[j];
		if (j >= 0)
			y[j] += 1e-3 * size;
		model_init(s);
		model_set(s, row[STEPS].t, y);
		model_out(s, j < 0 ? still : moved);
		if (j >= 0)
			y[j] = from;
		for (int i = 0; i < outputs && j >= 0; i++)
			gain[i] += fabs(moved[i] - still[i]) / (1e-3 * size);
	}
	free(s);
}

static void judge_run(void)
{
	void *const s = fresh();
	double *const out = malloc(sizeof *out * (size_t)(STEPS * outputs + 1));
	double *const u = malloc(sizeof *u * (size_t)(STEPS * inputs + 1)), y[MOST];
	float *const outf = malloc(sizeof *outf * (size_t)(STEPS * outputs + 1));
	float *const uf = malloc(sizeof *uf * (size_t)(STEPS * inputs + 1));
	const double ulps = 2 * of->adds * (in_float ? 0x1p-23 : 0x1p-52);
	double gain[MOST];
	find_gains(gain);
	if (!out || !u || !outf || !uf)
		exit(3);
	for (int k = 0; k < STEPS; k++)
		samples(k, u + k * inputs);
	narrow(u, uf, STEPS * inputs);
	for (int rows = 0; rows < 2; rows++) {
		model_init(s);
		if (of->model) {
			of->model->run(s, STEPS, inputs ? u : NULL, rows ? out : NULL);
		} else {
			of->modelf->run(s, STEPS, inputs ? uf : NULL, rows ? outf : NULL);
			if (rows)
				widen(outf, out, STEPS * outputs);
		}
		model_get(s, y);
		for (int i = 0; i < states; i++)
			near(y[i], row[STEPS].y[i], STEPS * ulps * size, rows ? "run with rows" : "run",
			     STEPS * h, state_name(i));
		for (int k = 0; k < STEPS && rows; k++)
			for (int i = 0; i < outputs; i++)
				near(out[k * outputs + i], row[k + 1].out[i],
				     (k + 1) * ulps * fmax(out_size, fmax(gain[i], 1) * size), "run, a row",
				     (k + 1) * h, output_name(i));
	}
	free(s), free(out), free(u), free(outf), free(uf);
}

/* Saved at a third of the run, and gone on with in another place. */
static void judge_restore(void)
{
	void *const s = fresh(), *const saved = fresh();
	double u[MOST], y[MOST];
	model_init(s);
	for (int k = 0; k < STEPS; k++) {
		if (k == STEPS / 3) {
			memcpy(saved, s, bytes());
			memset(s, 0, bytes());
			memcpy(s, saved, bytes());
		}
		samples(k, u);
		model_step(s, u);
	}
	model_get(s, y);
	if (!same_bits(y, row[STEPS].y, states))
		complain("a restored state goes on otherwise: %.17g, expected %.17g", y[0], row[STEPS].y[0]);
	free(s), free(saved);
}

static void judge_jump(void)
{
	static const int lengths[] = { 0, 1, 7, STEPS };
	void *const s = fresh();
	double y[MOST];
	for (int i = 0; i < 4; i++) {
		model_init(s);
		if (!model_jump(s, lengths[i]))
			break;
		model_get(s, y);
		near(model_time(s), row[lengths[i]].t, in_float ? 1e-6 : 1e-14, "time after a jump", lengths[i] * h,
		     "t");
		for (int j = 0; j < states; j++)
		    near(y[j], row[lengths[i]].y[j], rounding(lengths[i]) * size, "jump against steps", lengths[i] * h,
			 state_name(j));
	}
	free(s);
}

static void judge_at(void)
{
	const bool plain = is(of->scheme, "exact") && *of->changes == 0 && !is(of->class, "piecewise") &&
			   !is(of->class, "sticking");
	void *const s = fresh(), *const before = fresh();
	struct truth *solver = new_truth();
	struct beside eighths = begin_eighths(0, 0, NULL);
	double u[MOST], y[MOST], now[MOST], past[MOST] = {0}, finer[MOST] = {0};
	const bool all = whole() && of->slopes;
	model_init(s);
	for (int k = 0; k < STEPS; k++) {
		whole_samples(k, u);
		if (k % 5 == 2) {
			memcpy(before, s, bytes());
			if (!model_at(s, u, 0, y))
				break;
			for (int i = 0; i < states; i++)
				near(y[i], row[k].y[i], 0, "at(0) against get", row[k].t, state_name(i));
			model_at(s, u, of->model ? of->model->h : (double)of->modelf->h, y);
			for (int i = 0; i < states; i++)
				near(y[i], row[k + 1].y[i], (plain ? rounding(4) : bound()) * size, "at(h)",
					row[k].t, state_name(i));
			model_at(s, u, 0.375 * h, y);
			if (memcmp(before, s, bytes()) != 0)
				complain("at changes the state, t = %.17g", row[k].t);
			if (all) {
				double moved[2 * MOST];
				if (eighths.fine)
					get_inside(&eighths, row[k].t, row[k].y, u, 3, finer);
				over_step(past, u, h, moved);
				memcpy(now, row[k].y, sizeof now);
				if (advance(solver, k * h, (k + 0.375) * h, moved, now))
					for (int i = 0; i < states; i++)
						in_order(s, y[i], finer[i], now[i], bound() * size,
							"at(3/8 h) against CVODE", row[k].t, state_name(i));
				truth_free(solver);
				solver = new_truth();
			}
		}
		memcpy(past, u, sizeof past);
		model_step(s, u);
		if (eighths.fine)
			step_by_eighths(&eighths, u);
	}
	truth_free(solver);
	free(s), free(before), free(eighths.fine);
}

/* At an odd time, and where it is already. */
static void judge_set(void)
{
	void *const s = fresh();
	double u[MOST], y[MOST];
	model_init(s);
	for (int k = 0; k < STEPS; k++) {
		samples(k, u);
		if (k == 9)
			model_set(s, row[k].t, row[k].y);
		model_step(s, u);
	}
	model_get(s, y);
	const bool exact = is(of->scheme, "exact") && !is(of->class, "piecewise") && !is(of->class, "sticking");
	for (int i = 0; i < states; i++)
	    near(y[i], row[STEPS].y[i],
		 (exact          ? 4 * rounding(STEPS)
		  : in_float     ? 2e-3
		  : *of->changes ? bound()
		  : is(of->scheme, "radau") ? 1e-6      /* the step that it had found goes with set */
		  /* what earlier steps have left goes: where slopes jump both are off the truth, each by as much */
		  : !strncmp(of->scheme, "etdam", 5) && (is(of->class, "kinked") || is(of->class, "piecewise"))
		      ? 2 * bound()
					    : 1e-7) *
		     size,
		 "steps after set to where it is", STEPS * h, state_name(i));
	if (!whole() || (of->model ? of->model->params : of->modelf->params) > 8) {
		free(s);
		return;
	}
	for (int k = 0; k < 3; k++) {
		samples(k, u);
		model_step(s, u);
	}
	for (int i = 0; i < states; i++)
		y[i] = of->held ? row[STEPS / 2].y[i] : (double)((i * 29 + 7) % 41 - 20) / 64;
	model_set(s, 0.3515625, y);
	model_get(s, u);
	if (!same_bits(u, y, states))
		complain("get after set: %.17g, expected %.17g", u[0], y[0]);
	const double kept = size;
	size = fmax(size, 0.5);
	if (of->slopes) {
		judge_steps(s, 3, LATER, h, NULL, "steps after set against CVODE");
	} else {
		struct beside b = begin();
		for (int k = 0; k < 3; k++)
			step_beside(&b, k);
		set_beside(&b, 0.3515625, y);
		judge_beside(&b, 3, LATER, "steps after set against another scheme");
		end_beside(&b);
	}
	size = kept;
	free(s);
}

/* ---- other params ---- */

static bool retuned(void *s, const char *values, double *step)
{
	const int count = of->model ? of->model->params : of->modelf->params;
	double value[MOST];
	float narrowed[MOST];
	*step = of->model ? of->model->h : (double)of->modelf->h;
	for (int i = 0; i < count; i++) {
		const char *const name = of->model ? of->model->param_names[i] : of->modelf->param_names[i];
		value[i] = of->model ? of->model->param_values[i] : (double)of->modelf->param_values[i];
		for (const char *p = values; (p = strstr(p, name)); p++)
			if ((p == values || p[-1] == ' ') && p[strlen(name)] == '=')
				value[i] = strtod(p + strlen(name) + 1, NULL);
	}
	const char *const p = strstr(values, "step=");
	if (p)
		*step = strtod(p + 5, NULL);
	narrow(value, narrowed, count);
	const int status = of->model ? of->model->retune(s, value, *step)
				     : of->modelf->retune(s, narrowed, (float)*step);
	if (status)
		complain("retune to %s: status %d", *values ? values : "the spec's own values", status);
	return status == 0;
}

/* With the values written the operator is another one, where a scheme leaves what differs to a quadrature: both are off
 * the truth, each by as much as a scheme may, or by eighths of a step as much less as its order is. A series and a
 * collocation have none; where they step to a tolerance, an expression that rounds otherwise may choose other lengths
 * of steps, and each run is off by a tolerance a step. */
static double retuned_bound(int steps)
{
	static const char *const of_equations[] = { "taylor", "radau", "auto", "etdcol" };
	bool equations = strstr(of->retune, "step=") != NULL;
	for (size_t i = 0; i < sizeof of_equations / sizeof *of_equations; i++)
		equations = equations || strncmp(of->scheme, of_equations[i], strlen(of_equations[i])) == 0;
	return equations ? 10 * rounding(steps) + 2 * (steps + 1) * of->tolerance : 2 * bound();
}

/* With other params too: `stepped` is behind STEPS of their steps, and so far from 0 at most */
static void judge_tuned_jump(const void *stepped, double largest)
{
	void *const s = fresh();
	double y[MOST], expected[MOST], step;
	model_init(s);
	if (retuned(s, of->retune, &step) && model_jump(s, STEPS)) {
		model_get(s, y);
		model_get(stepped, expected);
		near(model_time(s), model_time(stepped), in_float ? 1e-6 : 1e-13, "time after a jump, retuned",
		     STEPS * step, "t");
		for (int i = 0; i < states; i++)
			near(y[i], expected[i], 2 * rounding(STEPS) * largest, "jump against steps, retuned",
			     STEPS * step, state_name(i));
	}
	free(s);
}

static void judge_retune(void)
{
	void *const s = fresh(), *const w = of->tuned ? malloc(of->tuned->size) : NULL;
	double y[MOST], expected[MOST], u[MOST], step, largest = 0;
	if (of->model ? !of->model->retune : !of->modelf->retune) {
		free(s), free(w);
		return;
	}
	model_init(s);
	if (retuned(s, "", &step)) {
		for (int k = 0; k < STEPS; k++) {
			samples(k, u);
			model_step(s, u);
		}
		model_get(s, y);
		for (int i = 0; i < states; i++)
		    near(y[i], row[STEPS].y[i], 10 * rounding(STEPS) * size, "retuned to the spec's own values",
			 STEPS * h, state_name(i));
	}
	if (w) {
		model_init(s);
		of->tuned->init(w);
		model_get(s, y);
		of->tuned->set(w, 0, y);
		struct beside eighths = strstr(of->retune, "step=") ? (struct beside){ NULL } : begin_eighths(0, 0, y);
		if (eighths.fine) {
			by_eighths(true);
			(void)retuned(eighths.fine, of->retune, &step);
			by_eighths(false);
		}
		if (retuned(s, of->retune, &step))
			for (int k = 0; k < STEPS; k++) {
				double finer[MOST] = {0};
				bool good = true;
				samples(k, u);
				model_step(s, u);
				if (eighths.fine) {
					step_by_eighths(&eighths, u);
					get_eighths(&eighths, finer, model_get);
				}
				of->tuned->step(w, inputs ? u : NULL);
				model_get(s, y);
				of->tuned->get(w, expected);
				for (int i = 0; i < states; i++)
					largest = fmax(largest, fabs(expected[i]));
				for (int i = 0; i < states; i++)
				    good = in_order(s, y[i], finer[i], expected[i], retuned_bound(k) * largest,
						    "retuned, against the spec with these values", (k + 1) * step,
						    state_name(i)) &&
					   good;
				model_out(s, y);
				if (eighths.fine)
					get_eighths(&eighths, finer, model_out);
				of->tuned->out(w, expected);
				for (int i = 0; i < outputs; i++)
					out_size = worse(out_size, fabs(expected[i]));
				for (int i = 0; i < outputs && !(in_float && largest > 1e3); i++)
				    good = in_order(s, y[i], finer[i], expected[i],
						    retuned_bound(k) * fmax(largest, out_size),
						    "retuned, outputs", (k + 1) * step, output_name(i)) &&
					   good;
				if (!good)
					break;
				if (k == STEPS - 1)
					judge_tuned_jump(s, largest);
			}
		end_beside(&eighths);
	}
	free(s), free(w);
}

static int judge(const char *name)
{
	for (of = subjects; of->name && !is(of->name, name);)
		of++;
	if (!of->name) {
		fprintf(stderr, "drive: no subject %s\n", name);
		return 2;
	}
	in_float = !of->model;
	states = in_float ? of->modelf->states : of->model->states;
	inputs = in_float ? of->modelf->inputs : of->model->inputs;
	outputs = in_float ? of->modelf->outputs : of->model->outputs;
	h = of->whole->h;
	if (states > MOST || outputs > MOST || of->whole->states > MOST || inputs > 4) {
		complain("%d states, %d inputs and %d outputs are too many for this program", states, inputs, outputs);
		return 1;
	}
	find_ramps();
	judge_rhs();
	run_steps();
	if (complaints == 0) {
		judge_truth();
		judge_losses();
		judge_solution();
		judge_run();
		judge_restore();
		judge_jump();
		judge_at();
		judge_set();
		judge_retune();
		judge_derivatives();
	}
	if (of->selftest) {
		const double ulps = of->selftest();
		const bool crosses = is(of->class, "piecewise") || is(of->class, "sticking");
		const double apart = of->sustained ? of->sustained() / 0.5 : 0;
		const double most = (size > 1e3 || crosses ? 1000 : 100) * of->ratio + 20 * apart;
		if (!(ulps <= most))
			complain("selftest: %.17g units in the last place, at most %g", ulps, most);
	}
	if (of->lanes) {
		const double off = of->lanes();
		if (!(off <= rounding(12)))
			complain("instances of the batch are off one alone by %.3g, tolerance %.3g", off, rounding(12));
	}
	if (complaints == 0)
		printf("%s: %s, CVODE %.1e, closed form %.1e\n", of->name, of->scheme, worst_truth, worst_solution);
	return complaints != 0;
}

static FILE *beside(const char *name, const char *ending, FILE *again)
{
	char path[100];
	snprintf(path, sizeof path, "%s.%s", name, ending);
	FILE *const file = again ? freopen(path, "w", again) : fopen(path, "w");
	if (!file) {
		perror(path);
		exit(99);
	}
	return file;
}

int main(int argc, char **argv)
{
	for (int i = 1; i < argc; i++) {
		const pid_t child = fork();
		if (child == 0) {
			beside(argv[i], "ran", stdout);
			beside(argv[i], "err", stderr);
			exit(judge(argv[i]));
		}
		int status = 0;
		if (child < 0 || waitpid(child, &status, 0) != child) {
			perror(argv[i]);
			return 99;
		}
		FILE *const file = beside(argv[i], "ended", NULL);
		fprintf(file, "%d\n", WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
		fclose(file);
	}
	return 0;
}

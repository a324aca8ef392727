//! The built-in cantilever's file for Rapier, run: a tip load of 0.9 of the collapse load is borne, 1.1 folds it for good.
//!
//! In this folder: `ductile export cantilever --engine rapier -o src`, then `cargo run --release`.

#[path = "cantilever_rapier.rs"]
#[allow(dead_code)]
mod joints;

use joints::{after_step, build, DT, ITERATIONS, JOINTS, PIECES};
use rapier2d::prelude::*;

const COLLAPSE: Real = 29375.0; // M_p / L, N
const STIFFNESS: Real = 2625000.0; // 3 E I / L³, N/m

/// Tip deflection under `share` of the collapse load, and after it is taken off [m].
fn push(share: Real, dt: Real, substeps: usize, iterations: usize) -> (Real, Real) {
    let (mut bodies, mut colliders) = (RigidBodySet::new(), ColliderSet::new());
    let (mut joints, mut trees) = (ImpulseJointSet::new(), MultibodyJointSet::new());
    let (pieces, handles) = build(&mut bodies, &mut joints);
    let tip = pieces[pieces.len() - 1];
    let end = point![0.5 * PIECES[PIECES.len() - 1].length, 0.0];
    let mut rest: Vec<Real> = JOINTS.iter().map(|j| j.rest_angle).collect();
    let mut plastic = vec![0.0; JOINTS.len()];
    let settings = IntegrationParameters {
        dt,
        num_solver_iterations: std::num::NonZeroUsize::new(substeps).unwrap(),
        num_internal_pgs_iterations: iterations,
        ..Default::default()
    };
    let mut pipeline = PhysicsPipeline::new();
    let (mut islands, mut broad, mut narrow) = (IslandManager::new(), DefaultBroadPhase::new(), NarrowPhase::new());
    let mut ccd = CCDSolver::new();
    let steps = (2.0 / dt) as usize; // rising for 1 s, held until 1.6 s, then off
    let (mut loaded, mut last) = (0.0, 0.0);
    for k in 0..steps {
        let time = k as Real / steps as Real;
        let load = if time < 0.8 { share * COLLAPSE * (2.0 * time).min(1.0) } else { 0.0 };
        let body = &mut bodies[tip];
        body.reset_forces(true);
        body.reset_torques(true);
        let at = body.position() * end;
        body.add_force_at_point(vector![0.0, -load], at, true);
        pipeline.step(
            &vector![0.0, 0.0], &settings, &mut islands, &mut broad, &mut narrow, &mut bodies, &mut colliders,
            &mut joints, &mut trees, &mut ccd, None, &(), &(),
        );
        after_step(&bodies, &mut joints, &handles, &mut rest, &mut plastic);
        last = -(bodies[tip].position() * end).y;
        if time < 0.8 {
            loaded = last;
        }
    }
    (loaded, last)
}

fn main() {
    let exact = 0.9 * COLLAPSE / STIFFNESS;
    println!("step, substeps, iterations: deflection at 0.9 of collapse over the exact one; left of 1.1");
    let tried = [(DT, 4, ITERATIONS), (DT, 30, ITERATIONS), (1.0 / 240.0, 4, ITERATIONS), (1.0 / 1000.0, 4, 1)];
    for (dt, substeps, iterations) in tried {
        let (loaded, _) = push(0.9, dt, substeps, iterations);
        let (_, left) = push(1.1, dt, substeps, iterations);
        println!("{dt:.6} s, {substeps}, {iterations}: {:.4}; {left:.3} m", loaded / exact);
    }
}

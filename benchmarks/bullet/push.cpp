// The built-in cantilever's file for Bullet, run: a tip load of 0.9 of the collapse load is borne, 1.1 folds it for good.
//
// In this folder, with Bullet's headers and libraries (Debian: libbullet-dev):
//     ductile export cantilever --engine bullet --joints 3 -o .
//     g++ -O2 push.cpp -I/usr/include/bullet -lBulletDynamics -lBulletCollision -lLinearMath -o push && ./push

#include "cantilever_bullet.cpp"

#include <algorithm>
#include <cstdio>

const btScalar collapse = 29375;  // M_p / L, N

struct Deflection
{
    btScalar loaded, left;  // of the tip, m
};

// A load that rises for 1 s, stays until 1.6 s and is gone then.
Deflection push(btScalar share, btScalar step, int iterations)
{
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    btEmptyShape shape;
    std::vector<btRigidBody*> bodies;
    createStructure(world, bodies, &shape);
    world.getSolverInfo().m_numIterations = iterations;
    for (btRigidBody* body : bodies)
        body->setActivationState(DISABLE_DEACTIVATION);
    btRigidBody& tip = *bodies.back();
    const btVector3 end(std::end(pieces)[-1].length / 2, 0, 0);
    Deflection found{};
    const int steps = int(2 / step);
    for (int k = 0; k < steps; ++k)
    {
        const btScalar time = btScalar(k) / steps;
        const btScalar load = time < 0.8 ? share * collapse * std::min(btScalar(1), 2 * time) : 0;
        tip.applyForce(btVector3(0, -load, 0), tip.getWorldTransform().getBasis() * end);
        world.stepSimulation(step, 0, step);
        found.left = -(tip.getWorldTransform() * end).y();
        if (time < 0.8)
            found.loaded = found.left;
    }
    return found;
}

int main()
{
    std::printf("step, iterations: deflection under 0.1 and 0.9 of the collapse load; left of 1.1\n");
    for (btScalar step : {1 / 60., 1 / 240., 1 / 1000.})
        for (int iterations : {30, 200})
            std::printf("%.6f s, %d: %.4f m, %.4f m; %.3f m\n", step, iterations, push(0.1, step, iterations).loaded,
                        push(0.9, step, iterations).loaded, push(1.1, step, iterations).left);
}

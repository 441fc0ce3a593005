// Bodies of links, and the simple forms that marks are made of, as three.js objects.
"use strict";
SK.makeShapes = (scene) => {
  const THREE = MeshCat.THREE;

  function decode(text, Type) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    return new Type(bytes.buffer);
  }

  const meshes = scene.meshes.map(({ vertices, faces, wide }) => {
    const indexed = new THREE.BufferGeometry();
    indexed.setAttribute("position", new THREE.BufferAttribute(decode(vertices, Float32Array), 3));
    indexed.setIndex(new THREE.BufferAttribute(decode(faces, wide ? Uint32Array : Uint16Array), 1));
    const geometry = indexed.toNonIndexed(); // edges stay sharp: one normal for each face
    geometry.computeVertexNormals();
    return geometry;
  });

  // A capsule along z, `length` between the centres of its two half spheres.
  function capsule(radius, length) {
    const points = [], steps = 12;
    for (let k = 0; k <= steps; k++) {
      const angle = -Math.PI / 2 + (k / steps) * (Math.PI / 2);
      points.push(new THREE.Vector2(radius * Math.cos(angle), radius * Math.sin(angle) - length / 2));
    }
    for (let k = 0; k <= steps; k++) {
      const angle = (k / steps) * (Math.PI / 2);
      points.push(new THREE.Vector2(radius * Math.cos(angle), radius * Math.sin(angle) + length / 2));
    }
    return new THREE.LatheGeometry(points, 36).rotateX(Math.PI / 2);
  }

  // three.js draws cylinders along y; URDF means z.
  const cylinder = (radius, length, segments = 48) =>
    new THREE.CylinderGeometry(radius, radius, length, segments).rotateX(Math.PI / 2);

  function geometryOf(body) {
    const [a, b, c] = body.size;
    switch (body.kind) {
      case "box": return new THREE.BoxGeometry(a, b, c);
      case "cylinder": return cylinder(a, b);
      case "sphere": return new THREE.SphereGeometry(a, 36, 24);
      case "capsule": return capsule(a, b);
      default: return meshes[body.mesh];
    }
  }

  const cone = (radius, length) =>
    new THREE.ConeGeometry(radius, length, 28).rotateX(Math.PI / 2).translate(0, 0, length / 2);
  const shaft = (radius) => cylinder(radius, 1, 20).translate(0, 0, 0.5);

  function circles() {
    const points = [];
    for (let k = 0; k < 96; k++)
      for (const step of [k, k + 1]) {
        const angle = (step / 96) * 2 * Math.PI, c = Math.cos(angle), s = Math.sin(angle);
        points.push([c, s, 0], [c, 0, s], [0, c, s]);
      }
    // Pairs of points for each of three circles, in the order that LineSegments wants.
    const ordered = [];
    for (let k = 0; k < points.length; k += 6)
      for (let ring = 0; ring < 3; ring++) ordered.push(points[k + ring], points[k + 3 + ring]);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(ordered.flat(), 3));
    return geometry;
  }

  return { geometryOf, cone, shaft, circles };
};

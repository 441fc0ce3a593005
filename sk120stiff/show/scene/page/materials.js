// Colours and surfaces. URDF colours are what a screen shows, so they become linear for the shader.
"use strict";
// The palette as the page has it at this moment, light or dark.
SK.colours = new Proxy({}, { get: (_, name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim() });
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => location.reload());
SK.makeMaterials = () => {
  const THREE = MeshCat.THREE;
  const linear = (colour) => new THREE.Color(colour).convertSRGBToLinear();
  const cache = new Map(), colours = SK.colours;

  function body([red, green, blue, alpha]) {
    const key = [red, green, blue, alpha].join();
    if (!cache.has(key)) {
      cache.set(key, new THREE.MeshStandardMaterial({
        color: new THREE.Color(red, green, blue).convertSRGBToLinear(),
        roughness: 0.52, metalness: 0.08, side: THREE.DoubleSide,
        transparent: alpha < 1, opacity: alpha, depthWrite: alpha >= 0.6,
      }));
    }
    return cache.get(key);
  }

  const glass = (colour, opacity) => new THREE.MeshPhongMaterial({
    color: linear(colour), transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide,
    shininess: 60, specular: new THREE.Color(0x333333),
  });
  // Marks are drawn over everything: an arrow inside the wrist must still be seen.
  const flat = (colour) => new THREE.MeshBasicMaterial({ color: linear(colour), depthTest: false, transparent: true });
  const line = (colour, opacity = 1) => new THREE.LineBasicMaterial({
    color: linear(colour), transparent: opacity < 1, opacity,
  });
  const named = new THREE.MeshStandardMaterial({ color: linear(colours.named), roughness: 0.5, metalness: 0.05, side: THREE.DoubleSide });
  const ghost = new THREE.MeshStandardMaterial({
    color: linear(colours.sky), transparent: true, opacity: 0.42, roughness: 0.8,
    side: THREE.DoubleSide, depthWrite: true,
    polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8, // behind the link where they touch
  });
  const namedGhost = ghost.clone();
  namedGhost.color = linear(colours.named);
  return { body, glass, flat, line, ghost, named, namedGhost, linear };
};

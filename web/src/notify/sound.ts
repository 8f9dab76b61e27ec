let context: AudioContext | null = null;

/** A short signal, without a file: two notes that rise, or three alike where somebody must act. */
export function play(urgent: boolean): void {
  context ??= new AudioContext();
  void context.resume();
  const notes = urgent ? [880, 880, 880] : [660, 880];
  notes.forEach((frequency, number) => {
    if (context === null) return;
    const begins = context.currentTime + number * 0.18;
    const tone = context.createOscillator();
    const loudness = context.createGain();
    tone.frequency.value = frequency;
    loudness.gain.setValueAtTime(0, begins);
    loudness.gain.linearRampToValueAtTime(0.3, begins + 0.01);
    loudness.gain.linearRampToValueAtTime(0, begins + 0.14);
    tone.connect(loudness).connect(context.destination);
    tone.start(begins);
    tone.stop(begins + 0.15);
  });
}

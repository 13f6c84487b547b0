"""Pictures and the page. Import the file you need: figures bring matplotlib, which ``--json`` alone should not wait for."""

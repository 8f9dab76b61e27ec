"""How well the stack navigates: drives through worlds that others drive through, too."""

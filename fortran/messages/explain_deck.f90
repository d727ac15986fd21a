!> Explanations of E01xx, W01xx, N01xx: what the reader of decks says.
module lopin_explain_deck
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: deck_explanations

contains

   subroutine deck_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call words(list)
      call data(list)
      call places(list)
      call notes(list)
   end subroutine deck_explanations

   subroutine words(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0100', 'the deck cannot be read', &
         & 'The path on the command line names no file that can be read; the message says why. '// &
         & 'Pipes and devices are refused, and files of more than 2.1 GB.', &
         & 'check the path from the folder in which the command runs.')
      call add_explanation(list, 'E0101', 'unknown keyword', &
         & 'A line begins with a star and a word that is not in the keyword table. Other '// &
         & 'codes skip such a line and may solve another problem than the one that was meant; '// &
         & 'Lopin never does. Abbreviated keywords are refused for the same reason: they hide '// &
         & 'misspellings.', &
         & 'take the keyword that is proposed, or look at `lopin doc --all`. A line that '// &
         & 'begins with ** is a comment.')
      call add_explanation(list, 'E0102', 'unknown parameter', &
         & 'The keyword is known, the parameter is not. A misspelt parameter that is skipped '// &
         & 'changes the answer in silence: *STEP, NLGOEM would be a small-strain step.', &
         & 'take the parameter that is proposed; `lopin doc ''*STEP''` lists the parameters '// &
         & 'of a keyword. A keyword line that ends with a comma goes on in the next line.')
      call add_explanation(list, 'E0106', 'bad value of a parameter', &
         & 'A parameter lacks its value, has a value that is not in its list, is not a number '// &
         & 'where one is needed, or a required parameter is missing.', &
         & '`lopin doc ''*KEYWORD''` lists the parameters, their values and defaults.')
      call add_explanation(list, 'E0108', 'known, but not yet there', &
         & 'The word is part of the language, and Lopin knows what it means, but this version '// &
         & 'cannot do it. It is refused rather than skipped, because the answer would be that '// &
         & 'of another problem.', &
         & 'remove the card if the problem does not need it.')
      call add_explanation(list, 'E0114', 'a parameter is given twice', &
         & 'The same parameter stands twice on one keyword line; which of the two values was '// &
         & 'meant cannot be known.', &
         & 'remove one of them.')
   end subroutine words

   subroutine data(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0103', 'a data line cannot be understood', &
         & 'A field is not a number where one is needed, there are more fields than the '// &
         & 'keyword has, or data stand under a keyword that has none. Most often a comma is '// &
         & 'missing: `210000 .3`.', &
         & 'separate fields by commas; numbers are written as 1, 1., .5, 1E3 or 1D3.')
      call add_explanation(list, 'E0104', 'decimal comma or semicolon', &
         & 'A comma separates fields, so `0,5` is the two numbers 0 and 5. The line then has '// &
         & 'more fields than the keyword allows.', 'write numbers with a point: 0.5.')
      call add_explanation(list, 'W0104', 'perhaps a decimal comma', &
         & 'The line is legal, but reads like numbers written with a comma: `210000,0,3` is '// &
         & 'Young''s modulus 210000, Poisson''s ratio 0 and temperature 3.', 'write `210000, 0.3`.')
      call add_explanation(list, 'E0109', 'a letter outside the deck''s alphabet', &
         & 'Keywords, labels and data are 7-bit ASCII, so that every code and editor reads '// &
         & 'them alike. Accents and other alphabets may stand in comments and in titles.', &
         & 'rename the label.')
      call add_explanation(list, 'E0110', 'data without a keyword', &
         & 'A data line belongs to the keyword above it; this one has none, or it is itself a '// &
         & 'keyword whose star is missing.', &
         & 'begin the deck with a keyword; write the star. A mesh file of CalculiX without '// &
         & 'keywords goes under the keyword that it fills: *NODE, then *INCLUDE.')
      call add_explanation(list, 'E0111', 'a quote is not closed', &
         & 'A label between double quotes must end on the line on which it begins.', &
         & 'close the quote.')
   end subroutine data

   subroutine places(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0105', &
         & 'an included file cannot be read, or there are too many', &
         & 'The file of *INCLUDE is looked for beside the file that names it, then beside the '// &
         & 'deck. A file that includes itself, even through others, would never end. At most '// &
         & '32 files may stand in one another, and at most 1000 in a deck.', &
         & 'the message shows the paths that were tried.')
      call add_explanation(list, 'E0107', 'a keyword in the wrong place', &
         & 'Some keywords belong to the model, some to a step, some must follow another '// &
         & 'directly: *ELASTIC follows *MATERIAL.', 'move the card; `lopin doc ''*KEYWORD''` '// &
         & 'names its place.')
      call add_explanation(list, 'E0113', 'something is not closed, or closed twice', &
         & '*STEP, *PART, *ASSEMBLY and *INSTANCE are closed by *END STEP, *END PART, *END '// &
         & 'ASSEMBLY and *END INSTANCE, in the opposite order.', 'add or remove the card.')
   end subroutine places

   subroutine notes(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0101', 'a keyword is read past', &
         & 'The card changes nothing in the answer of Lopin: it asks another code for an '// &
         & 'echo, a checkpoint, or describes physics that a static step without temperatures '// &
         & 'does not have.', '')
      call add_explanation(list, 'N0102', 'a parameter is read past', &
         & 'The parameter changes nothing in the answer of Lopin.', '')
      call add_explanation(list, 'N0103', 'a word of another code', &
         & 'The value belongs to another code, most often the name of a linear solver that is '// &
         & 'not part of Lopin; the default is used.', '')
      call add_explanation(list, 'N0105', 'another spelling', &
         & 'The value is spelt as in the lecture that Lopin follows, or as in common speech; '// &
         & 'it is read as the word that the manual has.', '')
      call add_explanation(list, 'N0104', 'a variable is left out of the output', &
         & 'The card asks for a result that Lopin does not compute, such as plastic strain or '// &
         & 'temperature in an elastic run. The others are written.', '')
   end subroutine notes
end module lopin_explain_deck

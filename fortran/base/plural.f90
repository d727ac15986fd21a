!> Nouns in messages: one or several.
module lopin_plural
   use lopin_text, only : to_text
   implicit none
   private
   public :: plural, plural_of

contains

   !> `1 element`, `2 elements`.
   pure function plural(number, noun) result(text)
      integer, intent(in) :: number
      character(len=*), intent(in) :: noun
      character(len=:), allocatable :: text

      text = to_text(number)//' '//noun
      if (number /= 1) text = to_text(number)//' '//plural_of(noun)
   end function plural

   !> `element sets`, `sets of springs`; nouns that end in s are several: `section controls`.
   pure function plural_of(noun) result(text)
      character(len=*), intent(in) :: noun
      character(len=:), allocatable :: text
      integer :: last

      last = index(noun, ' of ') - 1
      if (last < 1) last = len(noun)
      text = noun
      if (noun(last:last) /= 's') text = noun(:last)//'s'//noun(last + 1:)
   end function plural_of
end module lopin_plural

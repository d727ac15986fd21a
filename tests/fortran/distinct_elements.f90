!> Many words stand for one element (CPE4H for CPE4, say): tests of what elements compute take each
!> element once. That the words are read so is shown by test_element_type.
module distinct_elements
   use lopin_element_type, only : element_type, element_words, new_element_type
   implicit none
   private
   public :: stands_for_another

contains

   !> All that is computed with is that of a word before it, or of its own without the wish.
   logical function stands_for_another(word, wish) result(same)
      character(len=*), intent(in) :: word, wish
      type(element_type) :: element, other
      logical :: found
      integer :: i

      call new_element_type(element, word, wish, found)
      same = .false.
      do i = 1, findloc(element_words == word, .true., dim=1)
         if (same .or. element_words(i)(:3) /= word(:3)) cycle
         if (wish /= '' .or. element_words(i) /= word) then
            call new_element_type(other, trim(element_words(i)), '', found)
            same = same .or. are_the_same(element, other)
         end if
         if (wish /= '' .and. element_words(i) /= word) then
            call new_element_type(other, trim(element_words(i)), wish, found)
            same = same .or. are_the_same(element, other)
         end if
      end do
   end function stands_for_another

   !> All but the word and its note.
   pure logical function are_the_same(a, b) result(same)
      type(element_type), intent(in) :: a, b

      same = a%cell%name == b%cell%name .and. a%kind == b%kind .and. a%formulation == b%formulation &
         & .and. (a%patched .eqv. b%patched) .and. (a%projectable .eqv. b%projectable) &
         & .and. (a%axisymmetric .eqv. b%axisymmetric) .and. all(a%layers == b%layers) &
         & .and. (a%hourglass .eqv. b%hourglass) .and. a%ndim == b%ndim .and. a%ndof == b%ndof &
         & .and. a%nstress == b%nstress .and. a%ngauss == b%ngauss .and. a%nmode == b%nmode &
         & .and. (allocated(a%whole_weight) .eqv. allocated(b%whole_weight))
      if (same .and. a%ndof > 0) same = all(a%xi == b%xi) .and. all(a%weight == b%weight) &
         & .and. all(a%extrapolation == b%extrapolation)
      if (same .and. allocated(a%whole_weight)) same = size(a%whole_weight) == size(b%whole_weight)
   end function are_the_same
end module distinct_elements

!> Short lists of words in one text, separated by commas: `HARD,LINEAR,TIED`.
module lopin_word_list
   use lopin_text, only : upper, squeeze, without_blanks
   implicit none
   private
   public :: in_list, list_item, list_size

contains

   !> Whether a word is in a list separated by commas; neither case nor blanks count.
   pure logical function in_list(list, name)
      character(len=*), intent(in) :: list, name
      in_list = len_trim(name) > 0
      if (in_list) in_list = index(','//upper(without_blanks(list))//',', ','// &
         & upper(without_blanks(name))// &
         & ',') > 0
   end function in_list

   pure integer function list_size(list)
      character(len=*), intent(in) :: list
      integer :: i

      list_size = 0
      if (len_trim(list) == 0) return
      list_size = 1
      do i = 1, len(list)
         if (list(i:i) == ',') list_size = list_size + 1
      end do
   end function list_size

   !> The i-th item of a list separated by commas.
   pure function list_item(list, number) result(item)
      character(len=*), intent(in) :: list
      integer, intent(in) :: number
      character(len=:), allocatable :: item
      integer :: first, comma, i

      first = 1
      do i = 1, number
         comma = index(list(first:), ',')
         if (comma == 0) then
            item = squeeze(list(first:))
            return
         end if
         item = squeeze(list(first:first + comma - 2))
         first = first + comma
      end do
   end function list_item
end module lopin_word_list

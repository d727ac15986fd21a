!> Names of the parts of an output: what a reader shows, and a word that is safe in a file name.
!>
!> Two names that fold to the same word (blanks, letters with accents, small letters on disks that
!> do not tell them apart) get two files.
module lopin_part_names
   use lopin_text, only : to_text, upper
   use lopin_recorder_table, only : file_word
   implicit none
   private
   public :: part_name_type, name_parts

   type :: part_name_type
      character(len=:), allocatable :: name   !! what a reader shows, another one for each part
      character(len=:), allocatable :: word   !! in file names, likewise
   end type part_name_type

   !> Longer words leave no room for the rest of a file name.
   integer, parameter :: longest = 80

contains

   !> Set the words of a list of names, and tell equal names apart by -2, -3.
   subroutine name_parts(part)
      type(part_name_type), intent(inout) :: part(:)
      integer :: i, copy
      character(len=:), allocatable :: name, word

      do i = 1, size(part)
         name = part(i)%name
         word = trim(file_word(name(:min(len(name), longest))))
         part(i)%word = word
         copy = 1
         do while (any_before(i, .true.))
            copy = copy + 1
            part(i)%word = word//'-'//to_text(copy)
         end do
         copy = 1
         do while (any_before(i, .false.))
            copy = copy + 1
            part(i)%name = name//'-'//to_text(copy)
         end do
      end do
   contains
      logical function any_before(last, words)
         integer, intent(in) :: last
         logical, intent(in) :: words
         integer :: k

         any_before = .false.
         do k = 1, last - 1
            if (words) then
               any_before = any_before .or. upper(part(k)%word) == upper(part(last)%word)
            else
               any_before = any_before .or. part(k)%name == part(last)%name
            end if
         end do
      end function any_before
   end subroutine name_parts
end module lopin_part_names
